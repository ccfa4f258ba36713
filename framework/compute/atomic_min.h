// The least of what many threads of a kernel offer.
#pragma once

#include <atomic>
#include <cstdint>

#include "framework/base/api.h"
#include "framework/base/host_device.h"

namespace WEIR_API weir {

/// Lowers *least to `offered` if that is less; safe between the threads of one kernel. As the result depends
/// on no order, kernels that use nothing else between their threads are deterministic.
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

}  // namespace weir
