// The threads that make the lists of a group (packed_lists.h) side by side.
#pragma once

#include "framework/neighbors/packed_lists.h"

namespace weir {

/// The threads of a group of lists, a warp; the last group of a fluid may have fewer.
struct GroupThreads {
  unsigned mask;

  WEIR_HD GroupThreads(std::int64_t i, std::int64_t particles) {
    const std::int64_t left = particles - i / kListGroup * kListGroup;
    mask = left >= kListGroup ? ~0u : (1u << left) - 1;
  }

#ifdef __CUDA_ARCH__
  __device__ int min(int value) const {
#if __CUDA_ARCH__ >= 800
    return __reduce_min_sync(mask, value);
#else
    const int lane = static_cast<int>(threadIdx.x) % kListGroup;
    for (int step = kListGroup / 2; step > 0; step /= 2) {
      const int other = __shfl_xor_sync(mask, value, step);
      if ((mask >> (lane ^ step) & 1) != 0 && other < value) value = other;
    }
    return __shfl_sync(mask, value, 0);  // where threads are missing, it alone has heard of all
#endif
  }
  __device__ bool all(bool value) const {
    return __all_sync(mask, value) != 0;
  }
  __device__ int ofFirst(int value) const {
    return __shfl_sync(mask, value, 0);
  }
  /// What one has written to memory that they share is there for the others from here on.
  __device__ void meet() const {
    __syncwarp(mask);
  }
#else
  int min(int value) const {
    return value;
  }
  bool all(bool value) const {
    return value;
  }
  int ofFirst(int value) const {
    return value;
  }
  void meet() const {}
#endif
};

}  // namespace weir
