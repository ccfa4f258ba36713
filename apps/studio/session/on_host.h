// Elements of device arrays, on the host. Each call waits for the device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "framework/compute/array.h"
#include "framework/compute/host_copy.h"

namespace weir::studio {

/// The first elements of an array.
template <class T>
std::vector<T> onHost(const Array<T>& array, std::int64_t count) {
  HostCopy<T> copy(array.device());
  copy.resize(count);
  copy.start(0, array.data(), count);
  const std::span<const T> elements = copy.wait();
  return {elements.begin(), elements.end()};
}

/// Some of them, by their indices.
template <class T>
std::vector<T> onHost(const Array<T>& array, std::span<const std::int64_t> indices) {
  HostCopy<T> copy(array.device());
  copy.resize(static_cast<std::int64_t>(indices.size()));
  std::int64_t at = 0;
  for (const std::int64_t index : indices) copy.start(at++, array.data() + index, 1);
  const std::span<const T> elements = copy.wait();
  return {elements.begin(), elements.end()};
}

}  // namespace weir::studio
