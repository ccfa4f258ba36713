#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>

#include <fmt/format.h>

#ifdef __linux__
#include <sys/mman.h>
#endif

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "framework/base/interruption.h"
#include "framework/base/sanitizers.h"
#include "framework/compute/allocation_fault.h"
#include "framework/compute/cpu_profiler.h"
#include "framework/compute/cpu_threads.h"
#include "framework/compute/host_memory.h"
#include "framework/compute/memory_pool.h"

// Of the address sanitizer's runtime, where a plugin that is built with it has brought it along.
extern "C" __attribute__((weak)) void __asan_poison_memory_region(void const volatile* address,
                                                                  std::size_t size);

namespace weir {
namespace {

/// Gathers touch more pages of large arrays than a processor can look up at a time. Only a wish, so a system
/// that does not grant it is not an error.
void adviseHugePages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#ifdef __linux__
  constexpr std::uintptr_t kHugePage = std::uintptr_t{2} << 20;
  const auto address = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t begin = (address + kHugePage - 1) / kHugePage * kHugePage;
  const std::uintptr_t end = (address + bytes) / kHugePage * kHugePage;
  if (memory != nullptr && begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#endif
}

constexpr std::align_val_t kAlignment{256};  // bytes
// Behind each block, so that kernels may read the last vector of three numbers like one of four. Those that
// are watched do not (framework/compute/lanes.h), and what is written there is a mistake.
#ifdef WEIR_ADDRESS_SANITIZER
constexpr std::size_t kRoomBehind = 0;  // bytes
#else
constexpr std::size_t kRoomBehind = 16;  // bytes
#endif

void* allocateOnHost(std::size_t bytes) {
  // Linux promises memory that it does not have and kills the process when it is used. Asking first turns
  // that into an error for every block that is large enough to matter.
  constexpr std::size_t kLarge = std::size_t{64} << 20;
  if (bytes >= kLarge) {
    const std::size_t available = availableHostMemory();
    if (available > 0 && bytes > available) return nullptr;
  }
  void* memory = ::operator new(bytes + kRoomBehind, kAlignment, std::nothrow);
  adviseHugePages(memory, bytes);
#ifndef WEIR_ADDRESS_SANITIZER
  // The room is for our own kernels, which are not watched then; a plugin that writes there is.
  if (memory != nullptr && __asan_poison_memory_region != nullptr)
    __asan_poison_memory_region(static_cast<char*>(memory) + bytes, kRoomBehind);
#endif
  return memory;
}

/// One call of forRanges.
struct Launch {
  std::int64_t n, grain;
  void (*body)(void* context, std::int64_t begin, std::int64_t end);
  void* context;

  void run(std::int64_t k) const { body(context, k * grain, std::min(n, (k + 1) * grain)); }

  static void runOne(void* self, std::int64_t k) { static_cast<const Launch*>(self)->run(k); }
};

}  // namespace

struct CpuBackend::Impl {
  explicit Impl(int threadCount) : threads(threadCount) {}

  CpuThreads threads;
  MemoryPool pool{withFault(allocateOnHost),
                  [](void* memory, std::size_t) { ::operator delete(memory, kAlignment); }};
};

CpuBackend::CpuBackend(int threads, CpuIsa isa) : Device(DeviceKind::kCpu, "cpu"), isa_(isa) {
  WEIR_CHECK(threads >= 0);
  impl_ = std::make_unique<Impl>(threads);
  profiler_ = std::make_unique<CpuProfiler>();
}

CpuBackend::~CpuBackend() = default;

CpuDevice::CpuDevice(int threads, CpuIsa isa) : CpuAvx512(threads, isa) {
  WEIR_CHECK(isUsable(isa));
}

int CpuBackend::threads() const {
  return impl_->threads.count();
}

std::string CpuBackend::description() const {
  const std::string model = valueInFile("/proc/cpuinfo", "model name");
  constexpr double kGiB = 1024.0 * 1024.0;  // of KiB
  return fmt::format("{}, {} thread{}, {}, {:.0f} GiB", model.empty() ? "CPU" : model, threads(),
                     threads() == 1 ? "" : "s", cpuIsaName(isa()),
                     std::strtod(valueInFile("/proc/meminfo", "MemTotal").c_str(), nullptr) / kGiB);
}

void* CpuBackend::allocate(std::size_t bytes) {
  void* memory = impl_->pool.allocate(bytes);
  if (memory == nullptr && bytes > 0) {
    throw simulationError(fmt::format("out of memory: {} were asked for, {} are free", describeBytes(bytes),
                                      describeBytes(availableHostMemory())),
                          {}, "use fewer particles, which means a larger spacing");
  }
  return memory;
}

void CpuBackend::release(void* memory, std::size_t bytes) noexcept {
  impl_->pool.release(memory, bytes);
}

std::shared_ptr<void> CpuBackend::lend(void* memory) {
  return impl_->pool.lend(memory);
}

std::size_t CpuBackend::availableMemory() const {
  const std::size_t fromSystem = availableHostMemory();
  const MemoryUse use = memoryUse();
  return fromSystem > 0 ? fromSystem + (use.reserved - use.inUse) : 0;
}

MemoryUse CpuBackend::memoryUse() const {
  return impl_->pool.use();
}

void CpuBackend::upload(void* to, const void* fromHost, std::size_t bytes) {
  copy(to, fromHost, bytes);
}

void CpuBackend::download(void* toHost, const void* from, std::size_t bytes) {
  ++blockingReadbacks_;
  copy(toHost, from, bytes);
}

void CpuBackend::copy(void* to, const void* from, std::size_t bytes) {
  if (bytes > 0) std::memcpy(to, from, bytes);
}

void CpuBackend::fillBytes(void* to, int byte, std::size_t bytes) {
  // One thread alone writes a fraction of what the memory takes.
  constexpr std::int64_t kGrain = std::int64_t{1} << 17;
  struct Fill {
    char* to;
    int byte;
  } fill{static_cast<char*>(to), byte};
  forRanges(
      static_cast<std::int64_t>(bytes), kGrain,
      [](void* context, std::int64_t begin, std::int64_t end) {
        const Fill& f = *static_cast<const Fill*>(context);
        std::memset(f.to + begin, f.byte, static_cast<std::size_t>(end - begin));
      },
      &fill);
}

void CpuBackend::forRanges(std::int64_t n, std::int64_t grain,
                           void (*body)(void* context, std::int64_t begin, std::int64_t end), void* context) {
  WEIR_CHECK(grain > 0);
  if (n <= 0) return;
  const std::int64_t ranges = (n - 1) / grain + 1;
  Launch launch{.n = n, .grain = grain, .body = body, .context = context};
  // Waking threads for one range would cost more than the range.
  if (ranges == 1 || threads() == 1) {
    InterruptibleWork::endIfAsked();
    for (std::int64_t k = 0; k < ranges; ++k) launch.run(k);
    return;
  }
  impl_->threads.run(ranges, Launch::runOne, &launch);
}

}  // namespace weir
