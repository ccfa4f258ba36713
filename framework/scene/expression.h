// Arithmetic in scene files: "=spacing*4". Angles of sin, cos and tan are in degrees, like those of scenes.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/error.h"

namespace weir {

/// What the names in an expression stand for.
struct ExpressionNames {
  std::function<std::optional<double>(const std::string& name)> valueOf;
  std::function<std::vector<std::string>()> all;  ///< for messages
};

/// Whether it may name a variable: letters, digits and '_', beginning with a letter, and not a word of the
/// language of expressions, such as sqrt or pi.
bool isVariableName(std::string_view text);

/// The value of an expression without its '='; always finite. Throws a scene Error that has no place yet.
double evaluate(std::string_view expression, const ExpressionNames& names);

}  // namespace weir
