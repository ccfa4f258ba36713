// Elements of attributes, on the host. Each call waits for the device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "framework/compute/host_copy.h"
#include "framework/particles/attribute.h"

namespace weir::studio {

/// The first elements of an attribute.
template <class T>
std::vector<T> onHost(const Attribute<const T>& attribute, std::int64_t count) {
  HostCopy<T> copy(attribute.device());
  copy.resize(count);
  copy.start(0, attribute.read().data(), count);
  const std::span<const T> elements = copy.wait();
  return {elements.begin(), elements.end()};
}

/// Some of them, by their indices.
template <class T>
std::vector<T> onHost(const Attribute<const T>& attribute, std::span<const std::int64_t> indices) {
  HostCopy<T> copy(attribute.device());
  copy.resize(static_cast<std::int64_t>(indices.size()));
  const T* const from = attribute.read().data();
  std::int64_t at = 0;
  for (const std::int64_t index : indices) copy.start(at++, from + index, 1);
  const std::span<const T> elements = copy.wait();
  return {elements.begin(), elements.end()};
}

}  // namespace weir::studio
