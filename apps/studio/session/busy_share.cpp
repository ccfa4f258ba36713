#include "apps/studio/session/busy_share.h"

#include <algorithm>

namespace weir::studio {

void BusyShare::take(Time now, double stepSeconds) {
  constexpr auto kWindow = std::chrono::seconds(1);
  if (!samples_.empty() && stepSeconds < samples_.back().stepSeconds) samples_.clear();
  samples_.push_back({now, stepSeconds});
  while (samples_.size() > 2 && now - samples_[1].at >= kWindow) samples_.pop_front();
}

double BusyShare::share() const {
  if (samples_.size() < 2) return 0;
  const double seconds = std::chrono::duration<double>(samples_.back().at - samples_.front().at).count();
  if (seconds <= 0) return 0;
  // Two clock readings are never of the very same moment.
  return std::min(1.0, (samples_.back().stepSeconds - samples_.front().stepSeconds) / seconds);
}

}  // namespace weir::studio
