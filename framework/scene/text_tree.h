// The text of a scene file as a tree that loses nothing: every value and comment, and where it stands. For
// what changes the text itself, such as `weir format` and `weir upgrade`, and not what it means.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"

namespace WEIR_API weir {

struct TextComment {
  std::string_view text;         ///< with its // or /* */
  bool endsLine = false;         ///< what follows stands on another line
  bool blankLineBefore = false;  ///< between it and what is before it
};

/// A value with its name, where it has one. All views are into the text that was read.
struct TextItem {
  std::string_view name;   ///< of a member, with its quotes; else empty
  std::string_view value;  ///< from its first character to its last
  int line = 0;            ///< where the value starts, as Value::line
  int column = 0;
  std::vector<TextItem> items;  ///< of an object or array

  std::vector<TextComment> before;   ///< in front of it
  bool blankLineBefore = false;      ///< between it and what is before it; not for the first one
  std::vector<TextComment> after;    ///< on the line that it ends on
  std::vector<TextComment> opening;  ///< on the line of its opening bracket, where that line ends then
  std::vector<TextComment> last;     ///< in front of its closing bracket
  std::string_view comma;            ///< behind it; empty if there is none

  bool isObject() const { return value.starts_with('{'); }
  bool isContainer() const { return isObject() || value.starts_with('['); }
};

/// The tree of a text that parseScene or parseJson takes, as an array of one item: `last` is what follows
/// the value. The text must outlive it.
TextItem readTextTree(std::string_view text);

/// Replaces bytes of a text, which may be none.
struct TextEdit {
  std::size_t offset = 0, bytes = 0;
  std::string text;
};
/// With all edits, none of which overlap. Those at one offset are put in their order.
std::string withEdits(std::string_view text, std::vector<TextEdit> edits);

}  // namespace weir
