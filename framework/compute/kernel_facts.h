// What the CUDA runtime says of a kernel, asked once. For CUDA sources only.
#pragma once

#include <cuda_runtime.h>

#include "framework/compute/device.h"
#include "framework/compute/launch_queue.h"

namespace weir::detail {

/// Whether the device runs a kernel in clusters of that many blocks, of that many threads and so much shared
/// memory each, beside what the kernel has by itself. Where it does, the kernel gets it from now on.
static inline bool mayCluster(const CudaDevice& device, const void* kernel, unsigned blocks, unsigned threads,
                              unsigned bytes) {
  unsigned& known = device.launches().facts(kernel).sharedBytes;
  if (known != LaunchQueue::kUnknown) return bytes <= known;
  int can = 0, max = 0, together = 0;
  device.check(cudaDeviceGetAttribute(&can, cudaDevAttrClusterLaunch, device.index()), "device");
  if (can != 0) {
    device.check(cudaDeviceGetAttribute(&max, cudaDevAttrMaxSharedMemoryPerBlockOptin, device.index()),
                 "device");
    cudaFuncAttributes attributes{};
    device.check(cudaFuncGetAttributes(&attributes, kernel), "kernel");
    max -= static_cast<int>(attributes.sharedSizeBytes);
    device.check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, max), "kernel");
    cudaLaunchAttribute size{};
    size.id = cudaLaunchAttributeClusterDimension;
    size.val.clusterDim.x = blocks;
    size.val.clusterDim.y = size.val.clusterDim.z = 1;
    cudaLaunchConfig_t launch{};
    launch.gridDim = dim3(blocks);
    launch.blockDim = dim3(threads);
    launch.dynamicSmemBytes = static_cast<std::size_t>(max);
    launch.attrs = &size;
    launch.numAttrs = 1;
    // A part of a device may have too few multiprocessors.
    device.check(cudaOccupancyMaxActiveClusters(&together, kernel, &launch), "kernel");
  }
  known = together > 0 ? static_cast<unsigned>(max) : 0;
  return bytes <= known;
}

}  // namespace weir::detail
