#include "framework/base/table_text.h"

#include <algorithm>
#include <utility>

#include "framework/base/text.h"

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

}  // namespace

TableLines::TableLines(std::string_view text) : rest_(text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
}

bool TableLines::next() {
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

bool TableFields::next() {
  if (next_ > line_.size()) return false;
  begin_ = next_;
  while (begin_ < line_.size() && isBlank(line_[begin_])) ++begin_;
  quoted_ = begin_ < line_.size() && line_[begin_] == '"';
  const std::size_t search = quoted_ ? closingQuote() + 1 : begin_;
  const std::size_t end = std::min(line_.find(',', search), line_.size());
  next_ = end + 1;
  field_ = trimmed(line_.substr(begin_, end - begin_));
  if (quoted_) {
    if (field_.size() != search - begin_)
      throw error("there is text behind the quoted field " + inQuotes(field_));
    field_ = trimmed(field_.substr(1, field_.size() - 2));
  }
  return true;
}

std::string TableFields::text() const {
  std::string text;
  for (std::size_t i = 0; i < field_.size(); ++i) {
    if (quoted_ && field_.substr(i, 2) == "\"\"") ++i;
    text += field_[i];
  }
  return text;
}

Error TableFields::error(std::string what, std::string allowed) const {
  return ioError(std::move(what), std::move(allowed))
      .at({.line = lineNumber_, .column = static_cast<int>(begin_) + 1});
}

std::size_t TableFields::closingQuote() const {
  std::size_t at = line_.find('"', begin_ + 1);
  while (at != std::string_view::npos && line_.substr(at, 2) == "\"\"") at = line_.find('"', at + 2);
  if (at == std::string_view::npos) throw error("a quoted field does not end in its line", "a closing '\"'");
  return at;
}

std::string tableField(std::string_view text) {
  std::string field(text);
  for (char& c : field)
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7F) c = ' ';
  if (field.find_first_of(",\"#") == std::string::npos && trimmed(field) == field) return field;
  std::string quoted = "\"";
  for (const char c : field) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string tableLine(const std::vector<std::string>& fields) {
  std::string line;
  for (const std::string& field : fields) line += tableField(field) + ",";
  if (!line.empty()) line.pop_back();
  return line + "\n";
}

}  // namespace weir
