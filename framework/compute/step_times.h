// Times of steps, in memory that does not grow with their number.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "framework/compute/profiler.h"

namespace weir {

class StepTimes {
 public:
  static constexpr std::size_t kMost = std::size_t{1} << 16;

  void add(double ms) {
    if (count_ % every_ == 0) {
      if (kept_.size() == kMost) thin();
      if (count_ % every_ == 0) kept_.push_back(ms);
    }
    ++count_;
    sum_ += ms;
    max_ = std::max(max_, ms);
  }
  void clear() { *this = {}; }

  // Of all steps.
  std::int64_t count() const { return count_; }
  double mean() const { return count_ > 0 ? sum_ / static_cast<double>(count_) : 0; }
  double max() const { return max_; }
  /// In order: those of all steps, or of every second, fourth, … where there were more than kMost.
  const std::vector<double>& kept() const { return kept_; }

 private:
  void thin() {
    for (std::size_t k = 0; 2 * k < kept_.size(); ++k) kept_[k] = kept_[2 * k];
    kept_.resize(kept_.size() / 2);
    every_ *= 2;
  }

  std::vector<double> kept_;
  std::int64_t count_ = 0, every_ = 1;
  double sum_ = 0, max_ = 0;
};

/// What the profilers of both back ends are besides. It stands beside Profiler, whose layout plugins know.
class TimesSteps {
 public:
  /// Of steps that are measured by now; after Profiler::stepMs() all are.
  const StepTimes& stepTimes() const { return stepTimes_; }

 protected:
  StepTimes stepTimes_;
};

inline const StepTimes& stepTimesOf(const Profiler& profiler) {
  return dynamic_cast<const TimesSteps&>(profiler).stepTimes();
}

}  // namespace weir
