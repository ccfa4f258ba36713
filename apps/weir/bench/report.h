// The results of `weir bench` as lines of a table and as JSON.
#pragma once

#include <string>
#include <vector>

#include "apps/weir/bench/cases.h"
#include "apps/weir/bench/measurement.h"
#include "framework/base/value.h"

namespace weir::app {

/// One case of one size.
struct BenchResult {
  BenchCase benchCase;
  std::string size;              ///< "531441"; empty for a case without sizes
  std::vector<std::string> set;  ///< all changes to the scene
  Measurement measurement;

  /// "dam 531441"
  std::string name() const;
  /// Whether it showed that something is wrong, not only that there is too little memory.
  bool isBad() const;
};

std::string tableHead();
/// A line for each moment, or one that says why there are no times. `bandwidth` in bytes a second.
std::string tableLines(const BenchResult& result, double bandwidth);
/// "  dam 531441 late: water/neighbors 0.120, water/solver 0.300, …", for each moment; in ms a step.
std::string moduleLines(const BenchResult& result);

/// case, about, scene, set, size, memory {peak_bytes, bytes_per_particle}, and moments, or the reason why
/// there are none, "skipped" or "failed". A moment that diverged has the reason in the place of its times.
Value resultValue(const BenchResult& result, double bandwidth);

}  // namespace weir::app
