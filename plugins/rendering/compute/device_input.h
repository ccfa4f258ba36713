// DeviceInput<T>: numbers of the host as the kernels of a device see them.
#pragma once

#include <span>

#include "framework/compute/array.h"

namespace weir::rendering {

/// On the CPU kernels read them where they are, so they must stay there; to other devices they are copied.
template <class T>
class DeviceInput {
 public:
  explicit DeviceInput(Device& device) : copy_(device) {}

  ArrayView<const T> of(std::span<const T> values) {
    if (copy_.device().kind() == DeviceKind::kCpu)
      return {values.data(), static_cast<std::int64_t>(values.size())};
    copy_.assign(values);
    return static_cast<const Array<T>&>(copy_).view();
  }

 private:
  Array<T> copy_;
};

}  // namespace weir::rendering
