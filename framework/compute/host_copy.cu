#include <cuda_runtime.h>

#include <string>
#include <utility>

#include "framework/base/error.h"
#include "framework/compute/cuda_support.h"

namespace weir {

namespace {

/// Pinned memory, and an event behind the last copy to it.
class CudaHostCopyMemory final : public detail::HostCopyMemory {
 public:
  explicit CudaHostCopyMemory(CudaDevice& device)
      : device_(device), index_(device.index()), name_(device.name()) {
    makeCurrent();
    device_.check(cudaEventCreateWithFlags(&arrived_, cudaEventDisableTiming | cudaEventBlockingSync),
                  "frame copy");
  }

  ~CudaHostCopyMemory() override {
    static_cast<void>(cudaSetDevice(index_));
    free();
    static_cast<void>(cudaEventDestroy(arrived_));
  }

  void reserve(std::size_t bytes) override {
    makeCurrent();
    free();
    device_.check(cudaMallocHost(&bytes_, bytes), "frame copy");
  }

  void start(std::size_t at, const void* from, std::size_t bytes) override {
    makeCurrent();
    device_.check(cudaMemcpyAsync(static_cast<char*>(bytes_) + at, from, bytes, cudaMemcpyDeviceToHost,
                                  device_.stream()),
                  "frame copy");
    device_.check(cudaEventRecord(arrived_, device_.stream()), "frame copy");
  }

  // The device is at work for another thread, so nothing is asked of it here, not even for its error
  // messages.
  void wait() override {
    cudaError_t error = cudaSetDevice(index_);
    if (error == cudaSuccess) error = cudaEventSynchronize(arrived_);
    if (error != cudaSuccess)
      throw simulationError(std::string(cudaGetErrorString(error)) + " (" + cudaGetErrorName(error) +
                            ") on " + name_ + " in 'frame copy'");
  }

  const void* bytes() const override { return bytes_; }

 private:
  void makeCurrent() const { device_.check(cudaSetDevice(index_), "frame copy"); }
  void free() {
    static_cast<void>(cudaEventSynchronize(arrived_));  // a copy may still be on its way
    static_cast<void>(cudaFreeHost(std::exchange(bytes_, nullptr)));
  }

  CudaDevice& device_;
  int index_;
  std::string name_;
  cudaEvent_t arrived_ = nullptr;
  void* bytes_ = nullptr;
};

}  // namespace

std::unique_ptr<detail::HostCopyMemory> detail::makeCudaHostCopyMemory(CudaDevice& device) {
  return std::make_unique<CudaHostCopyMemory>(device);
}

}  // namespace weir
