// Statistics as columns of a table.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/value.h"

namespace WEIR_API weir {

/// The numbers of an object of statistics by their paths, "water.linear_momentum.x", in its order. Lists of
/// three numbers are vectors; other lists, and all that is no number, are left out. The names below "nodes"
/// stand without it, as they are enough to tell numbers apart.
std::vector<std::pair<std::string, std::string>> numbersOf(const Value& statistics);

}  // namespace weir
