// The sum of what many threads of a kernel add.
#pragma once

#include <atomic>
#include <cstdint>

#include "framework/base/api.h"
#include "framework/base/host_device.h"

namespace WEIR_API weir {

/// Adds to *sum; safe between the threads of one kernel. Integers, because their sums depend on no order, so
/// that kernels which use nothing else between their threads are deterministic.
WEIR_HD inline void atomicAdd(std::uint32_t* sum, std::uint32_t added) {
#ifdef __CUDA_ARCH__
  ::atomicAdd(sum, added);
#else
  std::atomic_ref<std::uint32_t>(*sum).fetch_add(added, std::memory_order_relaxed);
#endif
}

}  // namespace weir
