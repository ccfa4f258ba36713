// How long a rank waits for another that says nothing. Work between two messages may take long, such as that
// of rank 0 when it writes pictures, so there is no limit unless the user sets one.
#pragma once

#include <chrono>
#include <optional>

#include "framework/base/api.h"
#include "framework/base/error.h"

namespace WEIR_API weir {

/// From the environment variable WEIR_RANK_TIMEOUT, in seconds; none if it is not set. Throws a usage Error
/// for what is no number above 0.
std::optional<std::chrono::duration<double>> rankWaitLimit();

/// Of one that has waited so long for a rank.
Error waitedTooLong(int forRank, std::chrono::duration<double> limit);

}  // namespace weir
