// Loops in kernels that mostly end after a turn or none.
#pragma once

#include "framework/base/api.h"
#include "framework/base/host_device.h"

namespace WEIR_API weir {

/// Calls f(), at most that many times, as long as it returns true. CUDA compiles the turn once, as copies of
/// it take registers from threads that mostly need none.
template <class F>
WEIR_HD void repeatUpTo(int times, const F& f) {
#ifdef __CUDA_ARCH__
#pragma unroll 1
#endif
  for (int turn = 0; turn < times; ++turn)
    if (!f()) return;
}

}  // namespace weir
