// HostCopy<T>: elements on their way from a device to the host, for somebody who works beside the simulation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>

#include "framework/base/api.h"
#include "framework/base/check.h"
#include "framework/compute/device.h"

namespace WEIR_API weir {

namespace detail {
/// Host memory that a device can copy to while the host goes on; the back end decides what it is.
class HostCopyMemory {
 public:
  virtual ~HostCopyMemory() = default;
  /// Makes room for that many bytes; what was there is lost.
  virtual void reserve(std::size_t bytes) = 0;
  virtual void start(std::size_t at, const void* from, std::size_t bytes) = 0;
  virtual void wait() = 0;
  virtual const void* bytes() const = 0;
};
std::unique_ptr<HostCopyMemory> makeHostCopyMemory(Device& device);
}  // namespace detail

/// The thread that uses the device starts copies, and does not wait for them; then one thread, which may be
/// another, waits and reads. They must agree on whose turn it is. Copies are ordered with the device's work:
/// what it does afterwards may change the source. The memory is kept and used again; on CUDA it is pinned.
template <class T>
class HostCopy {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  explicit HostCopy(Device& device) : memory_(detail::makeHostCopyMemory(device)) {}

  /// Makes room for `size` elements, which are undefined. The copies of before must have been waited for.
  void resize(std::int64_t size) {
    WEIR_CHECK(size >= 0);
    if (size > capacity_) {
      // By half more, so that a growing fluid asks for memory rarely.
      capacity_ = size > capacity_ + capacity_ / 2 ? size : capacity_ + capacity_ / 2;
      memory_->reserve(static_cast<std::size_t>(capacity_) * sizeof(T));
    }
    size_ = size;
  }
  /// Asks for the elements from[0 … count) of the device, which become the elements at … at + count - 1 here.
  void start(std::int64_t at, const T* from, std::int64_t count) {
    WEIR_CHECK(at >= 0);
    WEIR_CHECK(count >= 0);
    WEIR_CHECK(at + count <= size_);
    if (count == 0) return;
    memory_->start(static_cast<std::size_t>(at) * sizeof(T), from,
                   static_cast<std::size_t>(count) * sizeof(T));
  }
  /// Waits until all copies have arrived. Throws a simulation Error if the device failed.
  std::span<const T> wait() {
    memory_->wait();
    return {static_cast<const T*>(memory_->bytes()), static_cast<std::size_t>(size_)};
  }

 private:
  std::unique_ptr<detail::HostCopyMemory> memory_;
  std::int64_t size_ = 0, capacity_ = 0;
};

}  // namespace weir
