// Elements of arrays moved in as few pieces as can be.
//
// CUDA splits what it reads or writes into accesses of four bytes unless it knows the alignment, and each of
// them asks for the same lines of the cache again: a gather of Vec4f takes nearly four times as long. Arrays
// begin at multiples of 256 bytes (memory_pool.cpp), so every Vec4f of one stands at a multiple of 16.
#pragma once

#include <cstdint>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

/// An element of an array.
template <class T>
WEIR_HD T loadWhole(const T& element) {
  return element;
}
template <class T>
WEIR_HD void storeWhole(T& element, const T& value) {
  element = value;
}

#ifdef __CUDACC__

template <>
WEIR_HD inline Vec4f loadWhole(const Vec4f& element) {
  const float4 v = *reinterpret_cast<const float4*>(&element);
  return {v.x, v.y, v.z, v.w};
}
template <>
WEIR_HD inline void storeWhole(Vec4f& element, const Vec4f& value) {
  *reinterpret_cast<float4*>(&element) = make_float4(value.x, value.y, value.z, value.w);
}

#endif

#ifdef __CUDACC__

/// Elements past the multiprocessor's own cache, for what may be read before the kernel waits
/// (kernel_overlap.h).
__device__ inline int loadPastCache(const int& element) {
  return __ldcg(&element);
}
__device__ inline std::uint16_t loadPastCache(const std::uint16_t& element) {
  return __ldcg(&element);
}
__device__ inline Vec3f loadPastCache(const Vec3f& element) {
  return {__ldcg(&element.x), __ldcg(&element.y), __ldcg(&element.z)};
}

#endif

/// A Vec3f in two pieces: every second one begins at a multiple of eight bytes, the others end there. That
/// takes more arithmetic, and pays where nothing but memory limits.
WEIR_HD inline Vec3f loadInTwo(const Vec3f& element) {
#ifdef __CUDA_ARCH__
  const float* at = &element.x;
  const bool odd = (reinterpret_cast<std::uintptr_t>(at) & 4) != 0;
  const float2 pair = *reinterpret_cast<const float2*>(odd ? at + 1 : at);
  const float single = odd ? at[0] : at[2];
  return odd ? Vec3f{single, pair.x, pair.y} : Vec3f{pair.x, pair.y, single};
#else
  return element;
#endif
}
WEIR_HD inline void storeInTwo(Vec3f& element, const Vec3f& value) {
#ifdef __CUDA_ARCH__
  float* at = &element.x;
  const bool odd = (reinterpret_cast<std::uintptr_t>(at) & 4) != 0;
  *reinterpret_cast<float2*>(odd ? at + 1 : at) =
      make_float2(odd ? value.y : value.x, odd ? value.z : value.y);
  *(odd ? at : at + 2) = odd ? value.x : value.z;
#else
  element = value;
#endif
}

}  // namespace weir
