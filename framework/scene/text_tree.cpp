#include "framework/scene/text_tree.h"

#include <algorithm>
#include <iterator>

#include "framework/base/check.h"
#include "framework/scene/json_text.h"

namespace weir {

namespace {

/// What stands between two tokens.
struct Gap {
  std::vector<TextComment> comments;
  std::size_t onFirstLine = 0;  // comments before the first line break
  int lineBreaks = 0;           // behind the last comment
  bool isOneLine() const { return onFirstLine == comments.size() && lineBreaks == 0; }
  bool endsLine() const { return onFirstLine < comments.size() || lineBreaks > 0; }
};

void move(std::vector<TextComment> from, std::vector<TextComment>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

class TreeReader {
 public:
  explicit TreeReader(std::string_view text) : tokens_(text) {}

  TextItem read() {
    TextItem document;
    Gap gap = readGap();
    document.items.emplace_back();
    lead(document.items.back(), std::move(gap.comments), gap.lineBreaks);
    readValue(document.items.back());
    gap = readGap();
    document.items.back().after = takeFirstLine(gap);
    document.last = std::move(gap.comments);
    return document;
  }

 private:
  char here() const { return tokens_.rest().empty() ? '\0' : tokens_.rest().front(); }

  void skip(std::size_t bytes) {
    const std::size_t end = tokens_.place().offset + bytes;
    while (tokens_.place().offset < end && !tokens_.rest().empty()) tokens_.skipOne();
  }

  int skipSpace() {
    const int line = tokens_.place().line;
    tokens_.skipSpace();
    return tokens_.place().line - line;
  }

  static std::size_t commentLength(std::string_view rest) {
    if (rest.starts_with("//")) return std::min(rest.find('\n'), rest.size());
    return rest.starts_with("/*") ? rest.find("*/", 2) + 2 : 0;
  }

  Gap readGap() {
    Gap gap;
    bool isFirstLine = true;
    for (;;) {
      gap.lineBreaks = skipSpace();
      if (gap.lineBreaks > 0) {
        isFirstLine = false;
        if (!gap.comments.empty()) gap.comments.back().endsLine = true;
      }
      std::string_view text = tokens_.rest().substr(0, commentLength(tokens_.rest()));
      if (text.empty()) return gap;
      skip(text.size());
      if (text.starts_with("//")) text = text.substr(0, text.find_last_not_of(" \t\r") + 1);
      gap.comments.push_back({text, text.starts_with("//"), gap.lineBreaks > 1});
      if (isFirstLine) ++gap.onFirstLine;
    }
  }

  static std::vector<TextComment> takeFirstLine(Gap& gap) {
    const auto end = gap.comments.begin() + static_cast<std::ptrdiff_t>(gap.onFirstLine);
    std::vector<TextComment> taken(gap.comments.begin(), end);
    gap.comments.erase(gap.comments.begin(), end);
    gap.onFirstLine = 0;
    return taken;
  }

  static void lead(TextItem& item, std::vector<TextComment> comments, int lineBreaks) {
    item.before = std::move(comments);
    item.blankLineBefore = lineBreaks > 1;
  }

  void readValue(TextItem& item) {
    item.line = tokens_.place().line, item.column = tokens_.place().column;
    const TextPlace start = tokens_.place();
    if (here() == '{' || here() == '[')
      readItems(item);
    else
      tokens_.next();
    item.value = tokens_.since(start);
  }

  static bool& blankLineBefore(TextItem& item) {
    return item.before.empty() ? item.blankLineBefore : item.before.front().blankLineBefore;
  }

  void readItems(TextItem& parent) {
    const bool named = here() == '{';
    const char close = named ? '}' : ']';
    skip(1);
    Gap gap = readGap();
    if (here() != close && gap.endsLine()) parent.opening = takeFirstLine(gap);
    while (here() != close) {
      TextItem& item = parent.items.emplace_back();
      lead(item, std::move(gap.comments), gap.lineBreaks);
      if (named) readName(item);
      if (parent.items.size() == 1) blankLineBefore(item) = false;
      readValue(item);
      gap = readBehind(item, close);
    }
    parent.last = std::move(gap.comments);
    skip(1);
  }

  /// Comments on both sides of the colon go in front of the name.
  void readName(TextItem& item) {
    const TextPlace start = tokens_.next();
    item.name = tokens_.since(start);
    move(readGap().comments, item.before);
    skip(1);
    move(readGap().comments, item.before);
  }

  /// To the next item or the closing bracket. What stands on the line of the item is its own, unless another
  /// item is on that line.
  Gap readBehind(TextItem& item, char close) {
    Gap gap = readGap();
    item.after = takeFirstLine(gap);
    const bool isSameLine = gap.isOneLine() && (item.after.empty() || !item.after.back().endsLine);
    if (here() != ',') return gap;
    item.comma = tokens_.rest().substr(0, 1);
    skip(1);
    Gap second = readGap();
    if (isSameLine && (second.endsLine() || here() == close)) move(takeFirstLine(second), item.after);
    move(std::move(second.comments), gap.comments);
    second.comments = std::move(gap.comments);
    return second;
  }

  JsonTokens tokens_;
};

}  // namespace

TextItem readTextTree(std::string_view text) {
  return TreeReader(text).read();
}

std::string withEdits(std::string_view text, std::vector<TextEdit> edits) {
  std::stable_sort(edits.begin(), edits.end(),
                   [](const TextEdit& a, const TextEdit& b) { return a.offset < b.offset; });
  std::string out;
  std::size_t at = 0;
  for (const TextEdit& edit : edits) {
    WEIR_CHECK(edit.offset >= at);
    WEIR_CHECK(edit.offset + edit.bytes <= text.size());
    out.append(text.substr(at, edit.offset - at)).append(edit.text);
    at = edit.offset + edit.bytes;
  }
  return out.append(text.substr(at));
}

}  // namespace weir
