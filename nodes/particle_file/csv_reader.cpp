#include "nodes/particle_file/csv_reader.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/text.h"
#include "nodes/particle_file/particle_columns.h"

namespace weir {

namespace {

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return text;
}

/// The lines of a text that are neither blank nor comments.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (rest_.substr(0, kByteOrderMark.size()) == kByteOrderMark) rest_.remove_prefix(kByteOrderMark.size());
  }

  /// Moves to the next one; false if there is none.
  bool next() {
    while (!rest_.empty()) {
      const std::size_t end = rest_.find('\n');
      line_ = rest_.substr(0, end);
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      ++number_;
      const std::string_view content = trimmed(line_);
      if (!content.empty() && content.front() != '#') return true;
    }
    return false;
  }

  std::string_view line() const { return line_; }
  int number() const { return number_; }  ///< from 1

 private:
  std::string_view rest_, line_;
  int number_ = 0;
};

/// Goes through the fields of one line.
class Fields {
 public:
  Fields(std::string_view line, int lineNumber) : line_(line), lineNumber_(lineNumber) {}

  /// Moves to the next one; false if there is none.
  bool next() {
    if (next_ > line_.size()) return false;
    begin_ = next_;
    while (begin_ < line_.size() && isBlank(line_[begin_])) ++begin_;
    const bool quoted = begin_ < line_.size() && line_[begin_] == '"';
    const std::size_t search = quoted ? closingQuote() + 1 : begin_;
    const std::size_t end = std::min(line_.find(',', search), line_.size());
    next_ = end + 1;
    field_ = trimmed(line_.substr(begin_, end - begin_));
    if (quoted) {
      if (field_.size() != search - begin_)
        throw error("there is text behind the quoted field " + inQuotes(field_));
      field_ = trimmed(field_.substr(1, field_.size() - 2));
    }
    return true;
  }

  std::string_view field() const { return field_; }
  Error error(std::string what, std::string allowed = {}) const {
    return ioError(std::move(what), std::move(allowed))
        .at({.line = lineNumber_, .column = static_cast<int>(begin_) + 1});
  }

 private:
  std::size_t closingQuote() const {
    std::size_t at = line_.find('"', begin_ + 1);
    while (at != std::string_view::npos && line_.substr(at, 2) == "\"\"") at = line_.find('"', at + 2);
    if (at == std::string_view::npos)
      throw error("a quoted field does not end in its line", "a closing '\"'");
    return at;
  }

  std::string_view line_, field_;
  int lineNumber_;
  std::size_t begin_ = 0, next_ = 0;
};

std::vector<std::string> headerNames(std::string_view line, int number) {
  std::vector<std::string> names;
  Fields fields(line, number);
  while (fields.next()) names.emplace_back(fields.field());
  return names;
}

float readNumber(const Fields& fields, std::size_t slot) {
  std::string_view text = fields.field();
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double number = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  const auto found = [&] {
    return std::string(ParticleColumns::nameOfSlot(slot)) + " is " + inQuotes(fields.field());
  };
  if (code == std::errc::invalid_argument || end != text.data() + text.size())
    throw fields.error(found(), "a number");
  const auto value = static_cast<float>(number);
  if (code != std::errc() || !std::isfinite(value))
    throw fields.error(found(), "a finite single-precision number");
  return value;
}

ParticleRow readRow(std::string_view line, int number, const ParticleColumns& columns) {
  ParticleRow row{};
  Fields fields(line, number);
  std::size_t column = 0;
  for (; fields.next(); ++column) {
    if (column == columns.size())
      throw fields.error("there are more fields than the header has columns",
                         std::to_string(columns.size()) + " fields");
    if (const auto slot = columns.slot(column)) row[*slot] = readNumber(fields, *slot);
  }
  if (column < columns.size())
    throw fields.error("the line ends after " + std::to_string(column) + " fields",
                       std::to_string(columns.size()) + " fields, as in the header");
  return row;
}

ParticleData readTable(std::string_view text) {
  Lines lines(text);
  if (!lines.next()) throw ioError("the file is empty", "a line of column names, then one line a particle");
  std::optional<ParticleColumns> columns;
  try {
    columns.emplace(headerNames(lines.line(), lines.number()));
  } catch (Error& error) {
    throw error.at({.line = lines.number(), .column = 1});
  }
  ParticleData data{.positions = {}, .velocities = {}, .unused = columns->unused()};
  while (lines.next()) addParticle(readRow(lines.line(), lines.number(), *columns), data);
  if (data.positions.empty()) throw ioError("there are no particles behind the header", "one line or more");
  return data;
}

}  // namespace

ParticleData CsvReader::read(const std::filesystem::path& file) const {
  const std::string text = readParticleFile(file);
  try {
    return readTable(text);
  } catch (Error& error) {
    throw error.at({.file = file.string()});
  }
}

}  // namespace weir
