// What scene files may have beyond JSON: comments and trailing commas.
#pragma once

#include <string>
#include <string_view>

namespace weir {

/// The text with every // and /* */ comment and every trailing comma as blanks, so that all that is left
/// keeps its line and column. Strings are untouched. Throws a scene Error for a comment that does not end.
std::string withoutComments(std::string_view text, const std::string& fileName);

}  // namespace weir
