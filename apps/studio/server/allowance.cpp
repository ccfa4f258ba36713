#include "apps/studio/server/allowance.h"

#include <algorithm>

namespace weir::studio {

Allowance::Seconds Allowance::spend(Seconds time, double share, Clock::time_point now) {
  left_ = std::min(kMax, left_ + share * Seconds(now - at_)) - time;
  at_ = now;
  if (left_ >= Seconds::zero()) return Seconds::zero();
  const Seconds wait = std::min(kLongestWait, (kTurn - left_) / share);
  left_ = std::max(left_, -share * kLongestWait);  // never to wait longer than that
  return wait;
}

}  // namespace weir::studio
