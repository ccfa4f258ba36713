// The machine that a simulation runs on: its memory, its clock of work, and how kernels reach it.
//
// A Device is an object that is passed, never a global. CpuDevice and CudaDevice are the two back ends; code
// that launches kernels is a template over them (see parallel.h) and is compiled by the host compiler, once
// for each instruction set (cpu_isa.h), and once by nvcc. Everything else speaks to Device alone.
//
// One thread at a time uses a device; allocate, release, lend and memoryUse alone may be called by any
// thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/cpu_isa.h"
#include "framework/compute/profiler.h"

struct CUstream_st;  // cudaStream_t is a pointer to it; named here so that no host file needs CUDA's headers

namespace WEIR_API weir {

namespace detail {
class LaunchQueue;
}

enum class DeviceKind { kCpu, kCuda };

/// Memory use of one device, in bytes.
struct MemoryUse {
  std::size_t inUse = 0;          ///< held by live arrays
  std::size_t peak = 0;           ///< the largest inUse so far
  std::size_t reserved = 0;       ///< held by the pool, in use or not
  std::size_t peakReserved = 0;   ///< the largest reserved so far
  std::uint64_t allocations = 0;  ///< requests that had to go to the system, not to the pool
};

class Device {
 public:
  virtual ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  DeviceKind kind() const { return kind_; }
  /// "cpu" or "cuda:0".
  const std::string& name() const { return name_; }
  /// What the hardware calls itself, with its size: "NVIDIA H100 80GB HBM3, 79 GiB".
  virtual std::string description() const = 0;

  /// Memory aligned to 256 bytes from this device's pool; throws a simulation Error that names the size and
  /// what is free when there is none. `release` gives it back to the pool in stream order; a captured graph
  /// therefore owns the memory it uses for as long as it may be replayed.
  virtual void* allocate(std::size_t bytes) = 0;
  virtual void release(void* memory, std::size_t bytes) noexcept = 0;
  /// Lets somebody else use what is allocated here, such as another language: until the result goes, the
  /// memory is given to nobody again, even when it has been released. The device must outlive the result.
  virtual std::shared_ptr<void> lend(void* memory) = 0;
  virtual MemoryUse memoryUse() const = 0;
  /// Bytes that arrays can still get, from the system and of what the pool holds idle; 0 if nobody knows.
  virtual std::size_t availableMemory() const = 0;

  // Copies are ordered with the kernels of this device. `download` waits for its result and is counted in
  // blockingReadbacks(), because a step of a simulation must not do that (see Readback in readback.h).
  virtual void upload(void* to, const void* fromHost, std::size_t bytes) = 0;
  virtual void download(void* toHost, const void* from, std::size_t bytes) = 0;
  virtual void copy(void* to, const void* from, std::size_t bytes) = 0;
  virtual void fillBytes(void* to, int byte, std::size_t bytes) = 0;

  /// Waits until all work so far is done; reports any error of that work.
  virtual void synchronize() = 0;

  // From beginBatch() to endBatch() a device may hold back the work that it is asked for, and then do all of
  // it as a whole, which is faster for work that is asked for again and again. What needs results (download,
  // synchronize, a Readback) ends the batch by itself. dropBatch() forgets work that has not begun.
  virtual void beginBatch() {}
  virtual void endBatch() {}
  virtual void dropBatch() noexcept {}

  std::uint64_t blockingReadbacks() const { return blockingReadbacks_; }

  /// Whether results must be bitwise the same from run to run (they always are on the CPU).
  bool deterministic() const { return deterministic_; }
  void setDeterministic(bool on) { deterministic_ = on; }

  Profiler& profiler() { return *profiler_; }
  const Profiler& profiler() const { return *profiler_; }

 protected:
  Device(DeviceKind kind, std::string name);

  std::unique_ptr<Profiler> profiler_;  // set by the back end's constructor
  std::uint64_t blockingReadbacks_ = 0;

 private:
  DeviceKind kind_;
  std::string name_;
  bool deterministic_ = false;
};

/// What all kernels on the CPU share, whatever instructions they are compiled for. Runs on the host's cores
/// through oneTBB. Results depend neither on the number of threads nor on the instructions.
class CpuBackend : public Device {
 public:
  ~CpuBackend() override;

  std::string description() const override;
  void* allocate(std::size_t bytes) override;
  void release(void* memory, std::size_t bytes) noexcept override;
  std::shared_ptr<void> lend(void* memory) override;
  MemoryUse memoryUse() const override;
  std::size_t availableMemory() const override;
  void upload(void* to, const void* fromHost, std::size_t bytes) override;
  void download(void* toHost, const void* from, std::size_t bytes) override;
  void copy(void* to, const void* from, std::size_t bytes) override;
  void fillBytes(void* to, int byte, std::size_t bytes) override;
  void synchronize() override {}

  int threads() const;
  /// The instructions that `dispatch` chooses kernels for.
  CpuIsa isa() const { return isa_; }

  /// Calls body(context, begin, end) for consecutive ranges that cover [0, n), on all threads. The ranges are
  /// [k*grain, min(n, (k+1)*grain)): they depend on n and grain alone.
  void forRanges(std::int64_t n, std::int64_t grain,
                 void (*body)(void* context, std::int64_t begin, std::int64_t end), void* context);

 protected:
  CpuBackend(int threads, CpuIsa isa);

 private:
  struct Impl;
  CpuIsa isa_;
  std::unique_ptr<Impl> impl_;
};

// The CPU as the kernels of one instruction set know it: types by which templates over the back end are told
// apart. A CpuDevice is all of them, and `dispatch` passes it as the one that it was opened for.
class CpuAvx2 : public CpuBackend {
 protected:
  using CpuBackend::CpuBackend;
};
class CpuAvx512 : public CpuAvx2 {
 protected:
  using CpuAvx2::CpuAvx2;
};

/// The CPU; as a back end, the one of kernels for any processor.
class CpuDevice final : public CpuAvx512 {
 public:
  /// `threads` 0 means one for every core the process may use; there may be more threads than cores. `isa` is
  /// one of usableCpuIsas().
  explicit CpuDevice(int threads = 0, CpuIsa isa = chosenCpuIsa());
};

/// Runs on one CUDA device, all work on one stream. Exists in every build; only builds with WEIR_HAS_CUDA can
/// construct one (see openDevice).
class CudaDevice final : public Device {
 public:
  explicit CudaDevice(int index = 0);
  ~CudaDevice() override;

  std::string description() const override;
  void* allocate(std::size_t bytes) override;
  void release(void* memory, std::size_t bytes) noexcept override;
  std::shared_ptr<void> lend(void* memory) override;
  MemoryUse memoryUse() const override;
  std::size_t availableMemory() const override;
  void upload(void* to, const void* fromHost, std::size_t bytes) override;
  void download(void* toHost, const void* from, std::size_t bytes) override;
  void copy(void* to, const void* from, std::size_t bytes) override;
  void fillBytes(void* to, int byte, std::size_t bytes) override;
  void synchronize() override;
  void beginBatch() override;
  void endBatch() override;
  void dropBatch() noexcept override;

  /// What was asked for so far has been issued to it.
  CUstream_st* stream() const;
  /// Through which kernels are launched (see launch_queue.h).
  detail::LaunchQueue& launches() const;
  int index() const;
  int multiprocessors() const;

  /// Throws a simulation Error for a CUDA error code other than success; it names `what`, and the node and
  /// module that the profiler says are at work.
  void check(int cudaError, std::string_view what) const;

 private:
  struct Impl;
  /// The same for what was gathered, where a call may have been noted by another module.
  void checkBatch(int cudaError) const;
  [[noreturn]] void fail(int cudaError, std::string_view what, const std::string& path) const;
  std::unique_ptr<Impl> impl_;
};

/// Ends the batch that it began, or drops it where an error travels.
class LaunchBatch {
 public:
  explicit LaunchBatch(Device& device) : device_(&device) { device.beginBatch(); }
  ~LaunchBatch() {
    if (device_ != nullptr) device_->dropBatch();
  }
  LaunchBatch(const LaunchBatch&) = delete;
  LaunchBatch& operator=(const LaunchBatch&) = delete;
  void end() { std::exchange(device_, nullptr)->endBatch(); }

 private:
  Device* device_;
};

/// What `weir info` prints and `--device auto` chooses from.
struct DeviceInfo {
  std::string name;  ///< what openDevice takes
  std::string description;
};
std::vector<DeviceInfo> listDevices();

/// Whether this build holds the CUDA back end.
bool builtWithCuda();

/// `spec` is "auto" (the first CUDA device if there is one that works, otherwise the CPU), "cpu", "cuda" or
/// "cuda:N". Throws a usage Error for anything else, and for CUDA where there is none, with the reason.
std::unique_ptr<Device> openDevice(std::string_view spec, int threads = 0);

/// The back end that this translation unit is being compiled for: a source file that is compiled twice ends
/// with explicit instantiations for it.
#if defined(__CUDACC__)
using ThisBackend = CudaDevice;
#elif defined(WEIR_FOR_AVX512)
using ThisBackend = CpuAvx512;
#elif defined(WEIR_FOR_AVX2)
using ThisBackend = CpuAvx2;
#else
using ThisBackend = CpuDevice;
#endif

}  // namespace weir
