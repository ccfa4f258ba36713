// What the CUDA runtime says of a kernel, asked once. For CUDA sources only.
#pragma once

#include <cuda_runtime.h>

#include "framework/compute/device.h"
#include "framework/compute/launch_queue.h"

namespace weir::detail {

/// Whether a block of a kernel may have so much shared memory. Where it may, it gets it from now on.
inline bool mayShare(const CudaDevice& device, const void* kernel, unsigned bytes) {
  constexpr unsigned kAnyMay = 40 << 10;  // beside what the kernel has by itself
  if (bytes <= kAnyMay) return true;
  unsigned& known = device.launches().facts(kernel).sharedBytes;
  if (known == LaunchQueue::kUnknown) {
    int most = 0;
    device.check(cudaDeviceGetAttribute(&most, cudaDevAttrMaxSharedMemoryPerBlockOptin, device.index()),
                 "device");
    cudaFuncAttributes attributes{};
    device.check(cudaFuncGetAttributes(&attributes, kernel), "kernel");
    const int dynamic = most - static_cast<int>(attributes.sharedSizeBytes);
    device.check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, dynamic),
                 "kernel");
    known = static_cast<unsigned>(dynamic);
  }
  return bytes <= known;
}

}  // namespace weir::detail
