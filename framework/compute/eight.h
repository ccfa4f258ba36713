// Eight elements of arrays side by side, for kernels that handle as many particles at a time on the CPU.
//
// A kernel whose operator() is a template takes an index of type std::int64_t as well as Eight. What it reads
// and writes by the functions below are numbers for the one and Lanes for the other, and with operators that
// know both, its body is written once. parallelForEights calls it with Eight where the processor has
// registers for it, and one by one at the end of an array, on other processors and on CUDA: bit for bit the
// same.
#pragma once

#include <string_view>
#include <type_traits>

#include "framework/base/api.h"
#include "framework/compute/lanes.h"
#include "framework/compute/parallel.h"
#include "framework/compute/wide_access.h"

// Where eight lanes are too wide for the processor's registers they are slower than one by one.
#if defined(WEIR_HAS_LANES) && defined(__AVX2__)
#define WEIR_HAS_EIGHT
#endif

namespace WEIR_API weir {

inline constexpr int kEight = 8;

/// The elements first, first + 1, …, first + 7; first is a multiple of eight.
struct Eight {
  std::int64_t first;
};

// The functions for one index, on all back ends.

template <class T>
WEIR_HD std::remove_const_t<T> read(const ArrayView<T>& from, std::int64_t i) {
  return loadWhole<std::remove_const_t<T>>(from[i]);
}
template <class T>
WEIR_HD void write(const ArrayView<T>& to, std::int64_t i, const std::type_identity_t<T>& value) {
  storeWhole<T>(to[i], value);
}
/// The index itself, to be compared with those of other particles.
WEIR_HD inline int asInt(std::int64_t i) {
  return static_cast<int>(i);
}

/// The index that lane `lane` stands for.
WEIR_HD inline std::int64_t indexOf(std::int64_t i, int /*lane*/) {
  return i;
}

/// Calls f(i) for the one index that this is, or one by one for the eight.
template <class F>
WEIR_HD void forEachOf(std::int64_t i, const F& f) {
  f(i);
}

namespace detail {
template <class Index>
struct NumberAt {
  using Type = float;
};
}  // namespace detail

/// What a float is at an index of this type: a float or Lanes.
template <class Index>
using NumberAt = typename detail::NumberAt<Index>::Type;

#ifdef WEIR_HAS_EIGHT

namespace detail {

template <>
struct NumberAt<Eight> {
  using Type = Lanes;
};

/// Four numbers from one place and four from another.
[[gnu::always_inline]] inline Lanes::Vector halves(const float* low, const float* high) {
  HalfLanes l, h;
  __builtin_memcpy(&l, low, sizeof l);
  __builtin_memcpy(&h, high, sizeof h);
  return __builtin_shufflevector(l, h, 0, 1, 2, 3, 4, 5, 6, 7);
}
[[gnu::always_inline]] inline void storeHalves(float* low, float* high, const Lanes::Vector& v) {
  const HalfLanes l = __builtin_shufflevector(v, v, 0, 1, 2, 3),
                  h = __builtin_shufflevector(v, v, 4, 5, 6, 7);
  __builtin_memcpy(low, &l, sizeof l);
  __builtin_memcpy(high, &h, sizeof h);
}

/// Within each half (a[A], a[B], b[C], b[D]).
template <int A, int B, int C, int D>
[[gnu::always_inline]] inline Lanes::Vector mixed(const Lanes::Vector& a, const Lanes::Vector& b) {
  return __builtin_shufflevector(a, b, A, B, C + 8, D + 8, A + 4, B + 4, C + 12, D + 12);
}

}  // namespace detail

[[gnu::always_inline]] inline Lanes read(const ArrayView<const float>& from, Eight i) {
  return Lanes::load(from.data + i.first);
}
[[gnu::always_inline]] inline Vec3<Lanes> read(const ArrayView<const Vec3f>& from, Eight i) {
  using detail::mixed;
  const float* p = &from.data[i.first].x;
  // x0 y0 z0 x1, y1 z1 x2 y2, z2 x3 y3 z3, and the same of the elements from the fourth on.
  const Lanes::Vector a = detail::halves(p, p + 12), b = detail::halves(p + 4, p + 16);
  const Lanes::Vector c = detail::halves(p + 8, p + 20);
  const Lanes::Vector xy = mixed<2, 3, 1, 2>(b, c), yz = mixed<1, 2, 0, 1>(a, b);
  return {Lanes(mixed<0, 3, 0, 2>(a, xy)), Lanes(mixed<0, 2, 1, 3>(yz, xy)), Lanes(mixed<1, 3, 0, 3>(yz, c))};
}
[[gnu::always_inline]] inline Vec4<Lanes> read(const ArrayView<const Vec4f>& from, Eight i) {
  constexpr int kInOrder[kEight] = {0, 1, 2, 3, 4, 5, 6, 7};
  return gatherLanes(from.data + i.first, kInOrder);
}
template <class T>
[[gnu::always_inline]] inline auto read(const ArrayView<T>& from, Eight i) requires(!std::is_const_v<T>) {
  return read(ArrayView<const T>(from), i);
}

[[gnu::always_inline]] inline void write(const ArrayView<float>& to, Eight i, const Lanes& value) {
  value.store(to.data + i.first);
}
[[gnu::always_inline]] inline void write(const ArrayView<Vec3f>& to, Eight i, const Vec3<Lanes>& value) {
  using detail::mixed;
  float* p = &to.data[i.first].x;
  const Lanes::Vector x = value.x.v, y = value.y.v, z = value.z.v;
  const Lanes::Vector xy = mixed<0, 2, 0, 2>(x, y), yz = mixed<1, 3, 1, 3>(y, z),
                      zx = mixed<0, 2, 1, 3>(z, x);
  detail::storeHalves(p, p + 12, mixed<0, 2, 0, 2>(xy, zx));
  detail::storeHalves(p + 4, p + 16, mixed<0, 2, 1, 3>(yz, xy));
  detail::storeHalves(p + 8, p + 20, mixed<1, 3, 1, 3>(zx, yz));
}
[[gnu::always_inline]] inline void write(const ArrayView<Vec4f>& to, Eight i, const Vec4<Lanes>& value) {
  float* p = &to.data[i.first].x;
  const Lanes::Vector x = value.x.v, y = value.y.v, z = value.z.v, w = value.w.v;
  const Lanes::Vector xyLow = __builtin_shufflevector(x, y, 0, 8, 1, 9, 4, 12, 5, 13);
  const Lanes::Vector xyHigh = __builtin_shufflevector(x, y, 2, 10, 3, 11, 6, 14, 7, 15);
  const Lanes::Vector zwLow = __builtin_shufflevector(z, w, 0, 8, 1, 9, 4, 12, 5, 13);
  const Lanes::Vector zwHigh = __builtin_shufflevector(z, w, 2, 10, 3, 11, 6, 14, 7, 15);
  detail::storeHalves(p, p + 16, detail::mixed<0, 1, 0, 1>(xyLow, zwLow));
  detail::storeHalves(p + 4, p + 20, detail::mixed<2, 3, 2, 3>(xyLow, zwLow));
  detail::storeHalves(p + 8, p + 24, detail::mixed<0, 1, 0, 1>(xyHigh, zwHigh));
  detail::storeHalves(p + 12, p + 28, detail::mixed<2, 3, 2, 3>(xyHigh, zwHigh));
}

inline LaneInts asInt(Eight i) {
  return LaneInts::from(static_cast<int>(i.first));
}
inline std::int64_t indexOf(Eight i, int lane) {
  return i.first + lane;
}
template <class F>
void forEachOf(Eight i, const F& f) {
  for (std::int64_t k = i.first; k < i.first + kEight; ++k) f(k);
}

#endif

/// Calls f(begin, end) for ranges that together are [0, count). All begins are multiples of eight. How the
/// ranges are cut depends on the number of threads, so results should not depend on it.
template <class F>
void forEachRange(CpuBackend& device, std::string_view name, Count count, const F& f) {
  const KernelScope scope(device.profiler(), name);
  const std::int64_t n = count.get();
  static_assert(detail::kSerialElements % kEight == 0);
  detail::forRanges(device, n, detail::cpuGrain(n, device.threads()), f);
}

/// Calls f(i) for every i in [0, count) as parallelFor does, or f(Eight{i}) for eight of them at a time.
template <class Backend, class F>
void parallelForEights(Backend& device, std::string_view name, Count count, const F& f) {
#ifdef WEIR_HAS_EIGHT
  if constexpr (!std::is_same_v<Backend, CudaDevice>) {
    forEachRange(device, name, count, [&](std::int64_t begin, std::int64_t end) {
      // A copy whose address nobody has, see parallelFor.
      const F kernel = f;
      std::int64_t i = begin;
      for (; i + kEight <= end; i += kEight) kernel(Eight{i});
      for (; i < end; ++i) kernel(i);
    });
    return;
  }
#endif
  parallelFor(device, name, count, f);
}

}  // namespace weir
