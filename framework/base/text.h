// Text that comes from users: whether it is UTF-8, and how to quote it in a message.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// The length in bytes of the UTF-8 sequence that starts at text[at]; 0 if there is no valid one.
std::size_t utf8Length(std::string_view text, std::size_t at);

bool isUtf8(std::string_view text);

/// Whether this may name a node or a module: letters, digits, '_' and '-', starting with a letter, at most
/// 100.
bool isName(std::string_view text);

/// With 'A' to 'Z' as 'a' to 'z' and all else as it is, whatever the locale.
std::string lowerCase(std::string_view text);

/// "a, b" as "a" and "b".
std::vector<std::string> commaList(std::string_view text);

/// Text as a message may show it: control characters and bytes that are no UTF-8 are escaped, and it is cut
/// after `longest` bytes. So no scene file can confuse a terminal or flood it.
std::string printable(std::string_view text, std::size_t longest = 100);

/// printable() between single quotes.
inline std::string inQuotes(std::string_view text) {
  return "'" + printable(text) + "'";
}

}  // namespace weir
