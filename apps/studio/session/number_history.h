// The numbers of a run over its time, for plots: kept for those who open a window later.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "framework/base/value.h"

namespace weir::studio {

class NumberHistory {
 public:
  /// Of more samples than this, every second one is forgotten.
  explicit NumberHistory(std::size_t max = 2000) : max_(max) {}

  void clear() { *this = NumberHistory(max_); }
  /// What runStatistics tells. All that was later is forgotten: the run has gone back.
  void add(const Value& numbers);
  /// {"times": [s, …], "values": {name: [number or null, …]}}: of each quantity as many as there are times,
  /// null where it was not told. Names are those of the reports of nodes, "water.compression.mean", a vector
  /// counts by its length, and "particles" and "step (ms)".
  Value value() const;
  /// What was added last; null for nothing.
  const Value& last() const { return last_; }

 private:
  /// Keeps so many samples, the first ones.
  void shorten(std::size_t count);
  void thin();

  std::size_t max_;
  std::vector<double> times_;                          // s
  std::map<std::string, std::vector<double>> values_;  // one for each time; NaN where it was not told
  Value last_;
};

}  // namespace weir::studio
