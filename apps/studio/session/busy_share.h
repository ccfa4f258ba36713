// How busy the device is.
#pragma once

#include <chrono>
#include <deque>

namespace weir::studio {

/// The share of the last second or so that a simulation's steps took, from the seconds that they took in all.
class BusyShare {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Where the seconds are fewer than before, another run has begun.
  void take(Time now, double stepSeconds);
  /// 0 to 1; 0 as long as nothing is known.
  double share() const;

 private:
  struct Sample {
    Time at;
    double stepSeconds;
  };
  /// Of the last second, and the last one before it.
  std::deque<Sample> samples_;
};

}  // namespace weir::studio
