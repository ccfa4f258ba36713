#include <cuda_runtime.h>

#include <mutex>
#include <set>
#include <string>
#include <utility>

#include "framework/base/error.h"
#include "framework/compute/cuda_support.h"

namespace weir {

namespace {

/// Pinned memory, and an event behind the last copy to it. Copies go by way of memory on the device, which is
/// quick, and from there to the host on a stream of their own while the device goes on. Where the device has
/// not room enough for that, they go straight to the host.
class CudaHostCopyMemory final : public detail::HostCopyMemory {
 public:
  explicit CudaHostCopyMemory(CudaDevice& device)
      : device_(device), index_(device.index()), name_(device.name()) {
    makeCurrent();
    device_.check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "frame copy");
    device_.check(cudaEventCreateWithFlags(&aside_, cudaEventDisableTiming), "frame copy");
    device_.check(cudaEventCreateWithFlags(&arrived_, cudaEventDisableTiming | cudaEventBlockingSync),
                  "frame copy");
  }

  ~CudaHostCopyMemory() override {
    static_cast<void>(cudaSetDevice(index_));
    free();
    static_cast<void>(cudaEventDestroy(arrived_));
    static_cast<void>(cudaEventDestroy(aside_));
    static_cast<void>(cudaStreamDestroy(stream_));
  }

  void reserve(std::size_t bytes) override {
    makeCurrent();
    free();
    device_.check(cudaMallocHost(&bytes_, bytes), "frame copy");
    std::size_t available = 0, total = 0;
    device_.check(cudaMemGetInfo(&available, &total), "frame copy");
    // Simulations that grow need the rest.
    if (bytes > available || available - bytes < total / 2) return;
    if (cudaMalloc(&staging_, bytes) == cudaSuccess) return;
    staging_ = nullptr;
    static_cast<void>(cudaGetLastError());
  }

  void start(std::size_t at, const void* from, std::size_t bytes) override {
    makeCurrent();
    const cudaStream_t work = device_.stream();
    char* to = static_cast<char*>(bytes_) + at;
    if (staging_ == nullptr) {
      device_.check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, work), "frame copy");
      device_.check(cudaEventRecord(arrived_, work), "frame copy");
      return;
    }
    char* aside = static_cast<char*>(staging_) + at;
    device_.check(cudaMemcpyAsync(aside, from, bytes, cudaMemcpyDeviceToDevice, work), "frame copy");
    device_.check(cudaEventRecord(aside_, work), "frame copy");
    device_.check(cudaStreamWaitEvent(stream_, aside_, 0), "frame copy");
    device_.check(cudaMemcpyAsync(to, aside, bytes, cudaMemcpyDeviceToHost, stream_), "frame copy");
    device_.check(cudaEventRecord(arrived_, stream_), "frame copy");
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
    static_cast<void>(cudaFree(std::exchange(staging_, nullptr)));
    static_cast<void>(cudaFreeHost(std::exchange(bytes_, nullptr)));
  }

  CudaDevice& device_;
  int index_;
  std::string name_;
  cudaStream_t stream_ = nullptr;
  cudaEvent_t aside_ = nullptr, arrived_ = nullptr;
  void *bytes_ = nullptr, *staging_ = nullptr;
};

class CudaMoment final : public detail::Moment {
 public:
  explicit CudaMoment(CudaDevice& device) : device_(device), index_(device.index()) {
    makeCurrent(device_);
    device_.check(cudaEventCreateWithFlags(&event_, cudaEventDisableTiming), "frame copy");
  }
  ~CudaMoment() override {
    static_cast<void>(cudaSetDevice(index_));
    static_cast<void>(cudaEventDestroy(event_));
  }

  void set() override {
    makeCurrent(device_);
    device_.check(cudaEventRecord(event_, device_.stream()), "frame copy");
  }

  // The device is at work for another thread: errors are the reader's.
  void letWait(Device& reader) override {
    const auto& cuda = static_cast<CudaDevice&>(reader);
    cuda.check(cudaSetDevice(cuda.index()), "frame copy");
    cuda.check(cudaStreamWaitEvent(cuda.stream(), event_, 0), "frame copy");
  }

 private:
  void makeCurrent(const CudaDevice& device) const { device.check(cudaSetDevice(index_), "frame copy"); }

  CudaDevice& device_;
  int index_;
  cudaEvent_t event_ = nullptr;
};

/// Lets the current device read the memory of another one, if it can; otherwise copies go by way of the host.
/// It holds for the process, and is asked for once for each pair.
void letReach(const CudaDevice& reader, const CudaDevice& owner) {
  static std::mutex mutex;
  static std::set<std::pair<int, int>> asked;
  const std::lock_guard lock(mutex);
  if (!asked.emplace(reader.index(), owner.index()).second) return;
  int can = 0;
  reader.check(cudaDeviceCanAccessPeer(&can, reader.index(), owner.index()), "copy between devices");
  if (can == 0) return;
  const cudaError_t error = cudaDeviceEnablePeerAccess(owner.index(), 0);
  static_cast<void>(cudaGetLastError());
  if (error != cudaErrorPeerAccessAlreadyEnabled) reader.check(error, "copy between devices");
}

}  // namespace

std::unique_ptr<detail::HostCopyMemory> detail::makeCudaHostCopyMemory(CudaDevice& device) {
  return std::make_unique<CudaHostCopyMemory>(device);
}

std::unique_ptr<detail::Moment> detail::makeCudaMoment(CudaDevice& device) {
  return std::make_unique<CudaMoment>(device);
}

void detail::copyBetween(CudaDevice& reader, void* to, const CudaDevice& owner, const void* from,
                         std::size_t bytes) {
  reader.check(cudaSetDevice(reader.index()), "copy between devices");
  const cudaStream_t stream = reader.stream();
  if (reader.index() == owner.index()) {
    reader.check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice, stream), "copy between devices");
    return;
  }
  letReach(reader, owner);
  reader.check(cudaMemcpyPeerAsync(to, reader.index(), from, owner.index(), bytes, stream),
               "copy between devices");
}

}  // namespace weir
