// What SharedByRanks::ranksReport() has of all ranks. All of them take part.
#pragma once

#include <cstdint>

#include "framework/base/api.h"
#include "framework/base/value.h"
#include "framework/communication/timed_ranks.h"

namespace WEIR_API weir {

/// {"mean", "max"} of what each rank gives.
Value meanAndMaxOfRanks(Communicator& ranks, double own);

/// By the names of RankWork, in milliseconds of the host a step, of so many steps.
Value stepTimesOfRanks(Communicator& ranks, const RankTimes& times, std::int64_t steps);

}  // namespace weir
