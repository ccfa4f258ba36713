// FrameElements<T>: what a picture needs of a frame, copied, or where it is.
#pragma once

#include <cstdint>

#include "framework/compute/frame_copy.h"

namespace weir::rendering {

template <class T>
class FrameElements {
 public:
  /// `lent`: nothing is copied, as the simulation does not go on before it was read.
  explicit FrameElements(Device& device, bool lent = false)
      : device_(&device), isLent_(lent), copy_(device) {}

  /// See FrameCopy. What is lent, this waits for.
  void start(ArrayView<const T> from, std::int64_t count) {
    if (!isLent_) return copy_.start(from, count);
    WEIR_CHECK(count <= from.size);
    device_->synchronize();
    lent_ = {from.data, count};
  }
  void start(const Array<T>& from, std::int64_t count) { start(from.view(), count); }

  std::int64_t size() const { return isLent_ ? lent_.size : copy_.size(); }
  ArrayView<const T> on(Device& reader, Array<T>& room) { return isLent_ ? lent_ : copy_.on(reader, room); }

 private:
  Device* device_;
  bool isLent_;
  ArrayView<const T> lent_;
  FrameCopy<T> copy_;
};

}  // namespace weir::rendering
