// What many threads of a kernel do to one number: add, lower it, set bits. All are of integers, and their
// results depend on no order, so kernels that use nothing else between their threads are deterministic.
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>

#include "framework/base/api.h"
#include "framework/base/host_device.h"

namespace WEIR_API weir {

/// Adds to *sum; safe between the threads of one kernel.
WEIR_HD inline void atomicAdd(std::uint32_t* sum, std::uint32_t added) {
#ifdef __CUDA_ARCH__
  ::atomicAdd(sum, added);
#else
  std::atomic_ref<std::uint32_t>(*sum).fetch_add(added, std::memory_order_relaxed);
#endif
}

/// Lowers *min to `offered` if that is less; safe between the threads of one kernel.
WEIR_HD inline void atomicMin(std::uint32_t* min, std::uint32_t offered) {
#ifdef __CUDA_ARCH__
  ::atomicMin(min, offered);
#else
  const std::atomic_ref<std::uint32_t> shared(*min);
  std::uint32_t now = shared.load(std::memory_order_relaxed);
  while (offered < now && !shared.compare_exchange_weak(now, offered, std::memory_order_relaxed)) {
  }
#endif
}
WEIR_HD inline void atomicMin(std::uint64_t* min, std::uint64_t offered) {
#ifdef __CUDA_ARCH__
  static_assert(sizeof(unsigned long long) == sizeof(std::uint64_t));
  ::atomicMin(reinterpret_cast<unsigned long long*>(min), static_cast<unsigned long long>(offered));
#else
  const std::atomic_ref<std::uint64_t> shared(*min);
  std::uint64_t now = shared.load(std::memory_order_relaxed);
  while (offered < now && !shared.compare_exchange_weak(now, offered, std::memory_order_relaxed)) {
  }
#endif
}

/// What stands there now: other threads may lower it at any time.
template <class T>
WEIR_HD T currentMin(const T* min) {
#ifdef __CUDA_ARCH__
  return *static_cast<const volatile T*>(min);
#else
  return std::atomic_ref<T>(*const_cast<T*>(min)).load(std::memory_order_relaxed);
#endif
}

/// Sets these bits of *word; safe between the threads of one kernel.
WEIR_HD inline void atomicOr(std::uint32_t* word, std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  ::atomicOr(word, bits);
#else
  std::atomic_ref<std::uint32_t>(*word).fetch_or(bits, std::memory_order_relaxed);
#endif
}

/// The place of the lowest bit of what is not 0.
WEIR_HD inline int lowestBit(std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  return __ffs(static_cast<int>(bits)) - 1;
#else
  return std::countr_zero(bits);
#endif
}

}  // namespace weir
