// The least of what many threads of a kernel offer.
#pragma once

#include <atomic>
#include <cstdint>

#include "framework/base/host_device.h"

namespace weir {

/// Lowers *least to `offered` if that is less; safe between the threads of one kernel. As the result depends
/// on no order, kernels that use nothing else between their threads are deterministic.
WEIR_HD inline void atomicMin(std::uint32_t* least, std::uint32_t offered) {
#ifdef __CUDA_ARCH__
  ::atomicMin(least, offered);
#else
  const std::atomic_ref<std::uint32_t> shared(*least);
  std::uint32_t now = shared.load(std::memory_order_relaxed);
  while (offered < now && !shared.compare_exchange_weak(now, offered, std::memory_order_relaxed)) {
  }
#endif
}
WEIR_HD inline void atomicMin(std::uint64_t* least, std::uint64_t offered) {
#ifdef __CUDA_ARCH__
  static_assert(sizeof(unsigned long long) == sizeof(std::uint64_t));
  ::atomicMin(reinterpret_cast<unsigned long long*>(least), static_cast<unsigned long long>(offered));
#else
  const std::atomic_ref<std::uint64_t> shared(*least);
  std::uint64_t now = shared.load(std::memory_order_relaxed);
  while (offered < now && !shared.compare_exchange_weak(now, offered, std::memory_order_relaxed)) {
  }
#endif
}

/// What stands there now: other threads may lower it at any time.
template <class T>
WEIR_HD T currentLeast(const T* least) {
#ifdef __CUDA_ARCH__
  return *static_cast<const volatile T*>(least);
#else
  return std::atomic_ref<T>(*const_cast<T*>(least)).load(std::memory_order_relaxed);
#endif
}

}  // namespace weir
