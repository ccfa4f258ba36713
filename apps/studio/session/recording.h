// What is kept of the frames of the present run: to be looked at again, and to go on from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "apps/studio/session/packet.h"
#include "framework/graph/state.h"

namespace weir::studio {

/// All that the future of a run depends on, at one of its frames; see Simulation::save.
using RunState = std::shared_ptr<const StateArrays>;

/// With what it takes to keep it: a frame of a small scene is not much larger than its place in the map.
std::int64_t bytesOf(const Packet& packet);
std::int64_t bytesOf(const RunState& state);

/// One of a kind for each frame, as far as there is room. `Kept` is a pointer, null for none.
template <class Kept>
class KeptFrames {
 public:
  /// Where they take more bytes than this, every second one is forgotten.
  explicit KeptFrames(std::int64_t max) : maxBytes_(max) {}

  void clear() { *this = KeptFrames(maxBytes_); }
  /// Frames come in any order; one that is there already is replaced.
  void add(std::int64_t frame, Kept kept) {
    if (frame % every_ != 0) return;
    Kept& place = frames_[frame];
    bytes_ -= bytesOf(place);
    place = std::move(kept);
    bytes_ += bytesOf(place);
    while (bytes_ > maxBytes_ && frames_.size() > 1) thin();
  }
  void forgetAfter(std::int64_t frame) {
    forget([&](std::int64_t f) { return f > frame; });
  }
  /// The one nearest to this frame; null if there is none.
  Kept nearest(std::int64_t frame) const {
    const auto after = frames_.lower_bound(frame);
    if (after == frames_.begin()) return frames_.empty() ? nullptr : after->second;
    const auto before = std::prev(after);
    if (after == frames_.end() || frame - before->first <= after->first - frame) return before->second;
    return after->second;
  }
  /// The last one that is not after this frame; null if there is none.
  Kept lastUpTo(std::int64_t frame) const {
    const auto after = frames_.upper_bound(frame);
    return after == frames_.begin() ? nullptr : std::prev(after)->second;
  }
  /// The first one that is not before this frame, with its own; nothing if there is none.
  std::optional<std::pair<std::int64_t, Kept>> firstFrom(std::int64_t frame) const {
    const auto after = frames_.lower_bound(frame);
    if (after == frames_.end()) return std::nullopt;
    return *after;
  }
  bool has(std::int64_t frame) const { return frames_.contains(frame); }
  /// Of frames, only multiples of this are kept.
  std::int64_t every() const { return every_; }
  std::int64_t bytes() const { return bytes_; }
  std::size_t size() const { return frames_.size(); }

 private:
  void thin() {
    every_ *= 2;
    forget([&](std::int64_t f) { return f % every_ != 0; });
  }
  template <class Which>
  void forget(Which which) {
    for (auto i = frames_.begin(); i != frames_.end();) {
      const bool gone = which(i->first);
      if (gone) bytes_ -= bytesOf(i->second);
      i = gone ? frames_.erase(i) : std::next(i);
    }
  }

  std::int64_t maxBytes_;
  std::int64_t bytes_ = 0;
  std::int64_t every_ = 1;
  std::map<std::int64_t, Kept> frames_;
};

using Recording = KeptFrames<Packet>;
using KeptStates = KeptFrames<RunState>;

}  // namespace weir::studio
