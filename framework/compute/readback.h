// Readback<T>: a value that comes from the device without anyone waiting for it.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <type_traits>

#include "framework/base/api.h"
#include "framework/compute/device.h"

namespace WEIR_API weir {

namespace detail {
/// One pinned slot of `bytes` and an event; the back end decides what they are.
class ReadbackSlot {
 public:
  virtual ~ReadbackSlot() = default;
  virtual void start(const void* from) = 0;
  virtual bool ready() = 0;  ///< whether the last start has arrived
  virtual void wait() = 0;
  virtual const void* bytes() const = 0;
};
std::unique_ptr<ReadbackSlot> makeReadbackSlot(Device& device, std::size_t bytes);
}  // namespace detail

/// At most one copy is under way. On the CPU it arrives at once.
template <class T>
class Readback {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  explicit Readback(Device& device) : slot_(detail::makeReadbackSlot(device, sizeof(T))) {}

  bool pending() const { return pending_; }
  /// Asks for *from (device memory) as it will be after the work so far. Nothing happens while one is
  /// pending.
  bool request(const T* from) {
    if (pending_) return false;
    slot_->start(from);
    return pending_ = true;
  }
  /// The value, once, if it has arrived; never waits.
  std::optional<T> poll() {
    if (!pending_ || !slot_->ready()) return std::nullopt;
    pending_ = false;
    return *static_cast<const T*>(slot_->bytes());
  }
  /// The value of the pending request; waits for it.
  T wait() {
    slot_->wait();
    pending_ = false;
    return *static_cast<const T*>(slot_->bytes());
  }

 private:
  std::unique_ptr<detail::ReadbackSlot> slot_;
  bool pending_ = false;
};

}  // namespace weir
