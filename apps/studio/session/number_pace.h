// How often the numbers of a run are made: a few times a second, where that costs little.
#pragma once

#include <algorithm>
#include <chrono>

namespace weir::studio {

/// Numbers take at most a hundredth of the time, by what the quicker of the last two took: where another
/// program had the processor meanwhile, the clock says nothing of them.
class NumberPace {
 public:
  using Clock = std::chrono::steady_clock;

  bool isDue(Clock::time_point now) const {
    return now - ended_ >= std::max<Clock::duration>(kEvery, kShare * cost_);
  }
  void made(Clock::time_point begun, Clock::time_point ended) {
    cost_ = std::min(last_, ended - begun);
    last_ = ended - begun;
    ended_ = ended;
  }

 private:
  static constexpr auto kEvery = std::chrono::milliseconds(250);
  static constexpr int kShare = 100;

  Clock::time_point ended_{};
  Clock::duration last_{}, cost_{};
};

}  // namespace weir::studio
