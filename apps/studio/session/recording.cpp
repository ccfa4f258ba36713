#include "apps/studio/session/recording.h"

#include <iterator>
#include <utility>

namespace weir::studio {

namespace {

/// With what it takes to keep it: a frame of a small scene is not much larger than its place in the map.
std::int64_t bytesOf(const Packet& packet) {
  constexpr std::int64_t kPlace = 160;
  return packet ? static_cast<std::int64_t>(packet->size()) + kPlace : 0;
}

}  // namespace

void Recording::clear() {
  frames_.clear();
  bytes_ = 0;
  every_ = 1;
}

void Recording::add(std::int64_t frame, Packet packet) {
  if (frame % every_ != 0) return;
  Packet& place = frames_[frame];
  bytes_ -= bytesOf(place);
  place = std::move(packet);
  bytes_ += bytesOf(place);
  while (bytes_ > maxBytes_ && frames_.size() > 1) thin();
}

void Recording::thin() {
  every_ *= 2;
  for (auto i = frames_.begin(); i != frames_.end();) {
    const bool kept = i->first % every_ == 0;
    if (!kept) bytes_ -= bytesOf(i->second);
    i = kept ? std::next(i) : frames_.erase(i);
  }
}

Packet Recording::nearest(std::int64_t frame) const {
  if (frames_.empty()) return nullptr;
  const auto after = frames_.lower_bound(frame);
  if (after == frames_.begin()) return after->second;
  const auto before = std::prev(after);
  if (after == frames_.end() || frame - before->first <= after->first - frame) return before->second;
  return after->second;
}

}  // namespace weir::studio
