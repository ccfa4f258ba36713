// The bits that many threads of a kernel set.
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>

#include "framework/base/api.h"
#include "framework/base/host_device.h"

namespace WEIR_API weir {

/// Sets these bits of *word; safe between the threads of one kernel. As the result depends on no order,
/// kernels that use nothing else between their threads are deterministic.
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
