// Tables as text: lines of fields that are separated by commas.
//
//   # a comment
//   x, y, "with, commas"
//
// Fields may have blanks around them, and may stand in double quotes, where "" is a quote. Lines end in LF or
// CRLF. A byte order mark is skipped.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/error.h"

namespace WEIR_API weir {

/// The lines of a text that are neither blank nor comments. The text must outlive it.
class TableLines {
 public:
  explicit TableLines(std::string_view text);

  /// Moves to the next one; false if there is none.
  bool next();

  std::string_view line() const { return line_; }
  int number() const { return number_; }  ///< from 1

 private:
  std::string_view rest_, line_;
  int number_ = 0;
};

/// Goes through the fields of one line.
class TableFields {
 public:
  TableFields(std::string_view line, int lineNumber) : line_(line), lineNumber_(lineNumber) {}

  /// Moves to the next one; false if there is none. Throws error() for a quote that does not end.
  bool next();

  /// As it stands in the text, without blanks and quotes around it.
  std::string_view field() const { return field_; }
  /// The same with one quote for each "" of a quoted field.
  std::string text() const;
  /// An io Error at the line and column (in bytes) of the field.
  Error error(std::string what, std::string allowed = {}) const;

 private:
  std::size_t closingQuote() const;

  std::string_view line_, field_;
  int lineNumber_;
  std::size_t begin_ = 0, next_ = 0;
  bool quoted_ = false;
};

/// The field as it must stand in a table: in quotes where it needs them, control characters as blanks.
std::string tableField(std::string_view text);
/// A line of such fields, with its end.
std::string tableLine(const std::vector<std::string>& fields);

}  // namespace weir
