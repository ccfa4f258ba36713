#include "python/src/stream_order.h"

#ifdef WEIR_HAS_CUDA
#include <cuda_runtime_api.h>
#endif

namespace weir::python {

#ifdef WEIR_HAS_CUDA

namespace {

const CudaDevice* cuda(const Device& device) {
  return device.kind() == DeviceKind::kCuda ? static_cast<const CudaDevice*>(&device) : nullptr;
}

/// Everything that comes after this in `second` begins when everything before it in `first` is done.
void order(const CudaDevice& device, cudaStream_t first, cudaStream_t second) {
  cudaEvent_t event = nullptr;
  device.check(cudaSetDevice(device.index()), "cudaSetDevice");
  device.check(cudaEventCreateWithFlags(&event, cudaEventDisableTiming), "cudaEventCreate");
  const cudaError_t recorded = cudaEventRecord(event, first);
  const cudaError_t waiting = recorded == cudaSuccess ? cudaStreamWaitEvent(second, event, 0) : recorded;
  cudaEventDestroy(event);  // it goes when it has been waited for
  device.check(waiting, "the order of streams");
}

}  // namespace

std::uintptr_t streamOf(const Device& device) {
  const CudaDevice* found = cuda(device);
  return found != nullptr ? reinterpret_cast<std::uintptr_t>(found->stream()) : 0;
}

void letStreamWait(const Device& device, std::uintptr_t stream) {
  if (const CudaDevice* found = cuda(device))
    order(*found, found->stream(), reinterpret_cast<cudaStream_t>(stream));
}

void waitForStream(const Device& device, std::uintptr_t stream) {
  if (const CudaDevice* found = cuda(device))
    order(*found, reinterpret_cast<cudaStream_t>(stream), found->stream());
}

#else

std::uintptr_t streamOf(const Device&) {
  return 0;
}
void letStreamWait(const Device&, std::uintptr_t) {}
void waitForStream(const Device&, std::uintptr_t) {}

#endif

}  // namespace weir::python
