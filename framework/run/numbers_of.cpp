#include "framework/run/numbers_of.h"

#include <fmt/format.h>

namespace weir {

namespace {

using Numbers = std::vector<std::pair<std::string, std::string>>;

void addNumbers(Numbers& numbers, const std::string& path, const Value& value) {
  const auto below = [&](const std::string& name) { return path.empty() ? name : path + "." + name; };
  if (value.isObject()) {
    for (const auto& [name, member] : value.asObject())
      addNumbers(numbers, path.empty() && name == "nodes" ? "" : below(name), member);
  } else if (value.isInt()) {
    numbers.emplace_back(path, fmt::format("{}", value.asInt()));
  } else if (value.isNumber()) {
    numbers.emplace_back(path, fmt::format("{}", value.asDouble()));
  } else if (value.isArray() && value.asArray().size() == 3 && value.asArray()[0].isNumber()) {
    for (std::size_t i = 0; i < 3; ++i)
      addNumbers(numbers, below(std::string(1, "xyz"[i])), value.asArray()[i]);
  }
}

}  // namespace

Numbers numbersOf(const Value& statistics) {
  Numbers numbers;
  addNumbers(numbers, "", statistics);
  return numbers;
}

}  // namespace weir
