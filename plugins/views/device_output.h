// DeviceOutput<T>: numbers of a device as the host sees them.
#pragma once

#include <optional>
#include <span>

#include "framework/compute/array.h"
#include "framework/compute/host_copy.h"

namespace weir::rendering {

/// From the CPU they are read where they are; from other devices they are copied.
template <class T>
class DeviceOutput {
 public:
  explicit DeviceOutput(Device& device) : device_(device) {}

  /// Waits for the device. Good until the next call, or until the numbers change.
  std::span<const T> of(ArrayView<const T> values) {
    if (device_.kind() == DeviceKind::kCpu) return {values.data, static_cast<std::size_t>(values.size)};
    if (!copy_) copy_.emplace(device_);
    copy_->resize(values.size);
    copy_->start(0, values.data, values.size);
    return copy_->wait();
  }
  std::span<const T> of(const Array<T>& array) { return of(array.view()); }

 private:
  Device& device_;
  std::optional<HostCopy<T>> copy_;
};

}  // namespace weir::rendering
