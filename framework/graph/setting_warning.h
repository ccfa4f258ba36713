// Warnings before a run of settings that are known to be unstable or not resolved: always with the number
// that says so, and with one that would be good.
#pragma once

#include <string>

#include "framework/base/api.h"
#include "framework/base/log.h"

namespace WEIR_API weir {

/// Warns: "node 'nozzle': FOUND; better: BETTER". `where` is "node 'nozzle'", `found` says what is wrong,
/// with its number, and `better` what to change, with the value from which it is well.
inline void warnOfSetting(Log& log, const std::string& where, const std::string& found,
                          const std::string& better) {
  log.warn(where + ": " + found + "; better: " + better);
}

/// How far a particle may move in one step, in spacings, so that it still meets its neighbours one by one.
inline constexpr double kMaxTravel = 0.5;
/// How many spacings something must measure at least to be more than single particles.
inline constexpr double kMinSpacings = 3;
/// For comparisons with such limits, so that what is given as exactly that passes.
inline constexpr double kSettingRounding = 1e-4;

}  // namespace weir
