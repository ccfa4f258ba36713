#include "framework/base/text.h"

#include <fmt/format.h>

#include <algorithm>

namespace weir {

std::size_t utf8Length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0u;
  };
  const auto isTail = [&](std::size_t i) { return byte(i) >= 0x80 && byte(i) <= 0xBF; };
  const unsigned lead = byte(0);
  if (at >= text.size()) return 0;
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return isTail(1) ? 2 : 0;
  if (lead >= 0xE0 && lead <= 0xEF) {
    // Not the overlong forms below U+0800, and not the surrogates U+D800 to U+DFFF.
    const bool second = lead == 0xE0 ? byte(1) >= 0xA0 : lead == 0xED ? byte(1) <= 0x9F : true;
    return isTail(1) && second && isTail(2) ? 3 : 0;
  }
  if (lead >= 0xF0 && lead <= 0xF4) {
    // Not the overlong forms below U+10000, and nothing above U+10FFFF.
    const bool second = lead == 0xF0 ? byte(1) >= 0x90 : lead == 0xF4 ? byte(1) <= 0x8F : true;
    return isTail(1) && second && isTail(2) && isTail(3) ? 4 : 0;
  }
  return 0;
}

bool isUtf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8Length(text, i);
    if (length == 0) return false;
    i += length;
  }
  return true;
}

bool isName(std::string_view text) {
  constexpr std::size_t kLongestName = 100;
  const auto isLetter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto isInner = [&](char c) { return isLetter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-'; };
  return !text.empty() && text.size() <= kLongestName && isLetter(text[0]) &&
         std::all_of(text.begin(), text.end(), isInner);
}

std::vector<std::string> commaList(std::string_view text) {
  std::vector<std::string> items;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    std::string_view item = text.substr(0, comma);
    while (item.starts_with(' ')) item.remove_prefix(1);
    items.emplace_back(item);
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return items;
}

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::string printable(std::string_view text, std::size_t longest) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8Length(text, i);
    const auto byte = static_cast<unsigned char>(text[i]);
    std::string piece;
    if (length == 0)
      piece = fmt::format("\\x{:02x}", byte);
    else if (byte == '\n')
      piece = "\\n";
    else if (byte == '\t')
      piece = "\\t";
    else if (byte < 0x20 || byte == 0x7F)
      piece = fmt::format("\\u{:04x}", byte);
    else
      piece = text.substr(i, length);
    if (out.size() + piece.size() > longest) return out + "…";
    out += piece;
    i += length == 0 ? 1 : length;
  }
  return out;
}

}  // namespace weir
