// DeviceInput<T>: numbers of a view as the kernels of a device see them.
#pragma once

#include <span>

#include "framework/compute/array.h"

namespace weir::rendering {

/// What is on the device is read where it is, so it must stay there, and so is all on the CPU; to other
/// devices numbers of the host are copied.
template <class T>
class DeviceInput {
 public:
  explicit DeviceInput(Device& device) : copy_(device) {}

  ArrayView<const T> of(std::span<const T> values, bool onDevice) {
    if (onDevice || copy_.device().kind() == DeviceKind::kCpu)
      return {values.data(), static_cast<std::int64_t>(values.size())};
    copy_.assign(values);
    return static_cast<const Array<T>&>(copy_).view();
  }

 private:
  Array<T> copy_;
};

}  // namespace weir::rendering
