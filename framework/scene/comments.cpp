#include "framework/scene/comments.h"

#include "framework/base/error.h"
#include "framework/scene/json_text.h"

namespace weir {

namespace {

class Blanking {
 public:
  Blanking(std::string_view text, const std::string& fileName) : text_(text), fileName_(fileName) {
    out_.reserve(text.size());
  }

  std::string run() {
    while (at_ < text_.size()) step();
    return std::move(out_);
  }

 private:
  void step() {
    const std::string_view rest = text_.substr(at_);
    if (rest.starts_with("//")) return blank(std::min(rest.find('\n'), rest.size()));
    if (rest.starts_with("/*")) return blank(blockComment(rest));
    if (rest[0] == '"') return copyString(rest);
    if (!isSpace(rest[0])) noteToken(rest[0]);
    copy(1);
  }

  static bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

  /// A comma counts as a trailing one where a value stands before it and the bracket behind it.
  void noteToken(char c) {
    if ((c == ']' || c == '}') && last_ == ',' && beforeLast_ != '\0' && !opensOrSeparates(beforeLast_))
      out_[lastAt_] = ' ';
    beforeLast_ = last_, last_ = c, lastAt_ = out_.size();
  }

  static bool opensOrSeparates(char c) { return c == '[' || c == '{' || c == ',' || c == ':'; }

  void copy(std::size_t bytes) {
    out_ += text_.substr(at_, bytes);
    at_ += bytes;
  }

  void copyString(std::string_view rest) {
    noteToken('"');
    std::size_t end = 1;
    while (end < rest.size() && rest[end] != '"' && rest[end] != '\n') end += rest[end] == '\\' ? 2 : 1;
    copy(std::min(end + 1, rest.size()));
  }

  std::size_t blockComment(std::string_view rest) const {
    const std::size_t end = rest.find("*/", 2);
    if (end != std::string_view::npos) return end + 2;
    JsonTokens tokens(out_);  // which has as many lines and columns as the text so far
    while (!tokens.rest().empty()) tokens.skipOne();
    const TextPlace& at = tokens.place();
    throw sceneError("the comment does not end", "a closing */")
        .at({.file = fileName_, .line = at.line, .column = at.column});
  }

  /// A column is a character, so a character of several bytes leaves one blank.
  void blank(std::size_t bytes) {
    for (const char c : text_.substr(at_, bytes))
      if (c == '\n' || c == '\r' || c == '\t')
        out_ += c;
      else if ((static_cast<unsigned char>(c) & 0xC0) != 0x80)
        out_ += ' ';
    at_ += bytes;
  }

  std::string_view text_;
  const std::string& fileName_;
  std::string out_;
  std::size_t at_ = 0;
  char beforeLast_ = '\0', last_ = '\0';  // of the characters that are neither space nor comment
  std::size_t lastAt_ = 0;
};

}  // namespace

std::string withoutComments(std::string_view text, const std::string& fileName) {
  return Blanking(text, fileName).run();
}

}  // namespace weir
