// Arrays of NumPy from vectors, whose memory they keep.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <utility>
#include <vector>

#include "framework/base/vec.h"
#include "framework/particles/attribute_types.h"

namespace weir::python {

namespace nb = nanobind;

/// The shape of `count` elements, and the type of their numbers.
template <class T>
struct ElementShape {
  using Number = T;
  static std::vector<std::size_t> of(std::size_t count) { return {count}; }
};
template <class T>
struct ElementShape<Vec3<T>> {
  using Number = T;
  static std::vector<std::size_t> of(std::size_t count) { return {count, 3}; }
};
template <>
struct ElementShape<Mat3f> {
  using Number = float;
  static std::vector<std::size_t> of(std::size_t count) { return {count, 3, 3}; }
};

template <class T>
nb::object toNumpy(std::vector<T> values, const std::vector<std::size_t>& shape) {
  using Number = typename ElementShape<T>::Number;
  auto* held = new std::vector<T>(std::move(values));
  const nb::capsule owner(held, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, Number>(reinterpret_cast<Number*>(held->data()), shape.size(),
                                                 shape.data(), owner));
}

template <class T>
nb::object toNumpy(std::vector<T> values) {
  const std::vector<std::size_t> shape = ElementShape<T>::of(values.size());
  return toNumpy(std::move(values), shape);
}

/// The elements of a contiguous array of numbers of that type on the host.
template <class T>
std::vector<T> fromNumpy(nb::handle object) {
  using Number = typename ElementShape<T>::Number;
  const auto array = nb::cast<nb::ndarray<const Number, nb::c_contig, nb::device::cpu>>(object);
  const auto* begin = reinterpret_cast<const T*>(array.data());
  return {begin, begin + array.size() * sizeof(Number) / sizeof(T)};
}

}  // namespace weir::python
