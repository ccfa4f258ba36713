// What device.cpp needs from the CUDA back end, in builds with it and without.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "framework/compute/frame_copy.h"
#include "framework/compute/host_copy.h"
#include "framework/compute/readback.h"

namespace weir::detail {

struct CudaProbe {
  int devices = 0;
  std::string reason;  ///< why there are none
};
CudaProbe probeCuda();

std::unique_ptr<ReadbackSlot> makeCudaReadbackSlot(CudaDevice& device, std::size_t bytes);
std::unique_ptr<HostCopyMemory> makeCudaHostCopyMemory(CudaDevice& device);
std::unique_ptr<Moment> makeCudaMoment(CudaDevice& device);
/// Copies in the order of the reader's work, directly where the two GPUs reach each other.
void copyBetween(CudaDevice& reader, void* to, const CudaDevice& owner, const void* from, std::size_t bytes);

}  // namespace weir::detail
