// FrameCopy<T>: elements of one moment, for another Device of the same hardware that works beside the first:
// the simulation goes on while somebody draws what it was.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "framework/base/api.h"
#include "framework/base/check.h"
#include "framework/compute/array.h"
#include "framework/compute/host_copy.h"

namespace WEIR_API weir {

namespace detail {
/// A moment in the work of a device.
class Moment {
 public:
  virtual ~Moment() = default;
  /// It is when all that the device was asked for so far is done.
  virtual void set() = 0;
  /// What `reader` is asked for from now on comes after it; the host does not wait.
  virtual void letWait(Device& reader) = 0;
};
std::unique_ptr<Moment> makeMoment(Device& device);

/// Whether that many bytes more may be held beside a simulation: it may grow, so as much must stay free as is
/// in use. Always on the CPU.
bool hasRoomBeside(const Device& device, std::size_t bytes);
}  // namespace detail

/// The thread that uses the device starts a copy, and does not wait for it; then threads that use devices of
/// the same hardware read it, and must have waited for what they did with it before the next copy is started.
/// The copy stays on the device, or goes to the host's memory where the device has little room. The memory is
/// kept and used again; the device must outlive it.
template <class T>
class FrameCopy {
 public:
  explicit FrameCopy(Device& device)
      : device_(&device), aside_(device), copied_(detail::makeMoment(device)) {}

  /// Copies the first `count` elements. What is asked of the device afterwards may change them.
  void start(const Array<T>& from, std::int64_t count) { start(from.view(), count); }
  void start(ArrayView<const T> from, std::int64_t count) {
    WEIR_CHECK(count >= 0);
    WEIR_CHECK(count <= from.size);
    size_ = count;
    isAside_ = makeRoom(count);
    if (isAside_) {
      aside_.resizeDiscarding(count);
      device_->copy(aside_.data(), from.data, static_cast<std::size_t>(count) * sizeof(T));
      copied_->set();
      return;
    }
    if (!host_) host_.emplace(*device_);
    host_->resize(count);
    host_->start(0, from.data, count);
  }

  std::int64_t size() const { return size_; }

  /// What kernels of `reader` see from now on. `room` is an array of that device for what must come from the
  /// host; then this waits for it.
  ArrayView<const T> on(Device& reader, Array<T>& room) {
    WEIR_CHECK(reader.name() == device_->name());
    if (!isAside_) {
      room.assign(host_ ? host_->wait() : std::span<const T>());
      return std::as_const(room).view();
    }
    copied_->letWait(reader);
    return std::as_const(aside_).view();
  }

 private:
  bool makeRoom(std::int64_t count) {
    if (count <= aside_.capacity()) return true;
    const std::int64_t capacity = grownSize(aside_.capacity(), count);
    aside_ = Array<T>(*device_);
    if (!detail::hasRoomBeside(*device_, static_cast<std::size_t>(capacity) * sizeof(T))) return false;
    aside_.reserveDiscarding(capacity);
    return true;
  }

  Device* device_;
  std::int64_t size_ = 0;
  bool isAside_ = false;
  Array<T> aside_;
  std::unique_ptr<detail::Moment> copied_;
  std::optional<HostCopy<T>> host_;
};

}  // namespace weir
