// The frames of the present run that can be looked at again.
#pragma once

#include <cstdint>
#include <map>

#include "apps/studio/session/packet.h"

namespace weir::studio {

class Recording {
 public:
  /// Where frames take more bytes than this, every second one is forgotten.
  explicit Recording(std::int64_t max) : maxBytes_(max) {}

  void clear();
  /// Frames come in any order; one that is there already is replaced.
  void add(std::int64_t frame, Packet packet);
  /// The frame nearest to this one; null if there is none.
  Packet nearest(std::int64_t frame) const;
  /// Of frames, this and its multiples are kept.
  std::int64_t every() const { return every_; }
  std::int64_t bytes() const { return bytes_; }
  std::size_t size() const { return frames_.size(); }

 private:
  void thin();

  std::int64_t maxBytes_;
  std::int64_t bytes_ = 0;
  std::int64_t every_ = 1;  // only multiples of this are kept
  std::map<std::int64_t, Packet> frames_;
};

}  // namespace weir::studio
