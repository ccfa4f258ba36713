#include "framework/compute/memory_pool.h"

#include <algorithm>
#include <bit>
#include <new>

#include <fmt/format.h>

namespace weir {
namespace {

constexpr std::size_t kAlignment = 256;  // bytes
constexpr std::size_t kLargest = std::size_t{1} << 62;

/// A block that was idle for that many requests is a leftover of arrays that have grown since.
constexpr std::uint64_t kKeepRequests = 4096;

}  // namespace

MemoryPool::MemoryPool(Allocate allocate, Free free)
    : systemAllocate_(std::move(allocate)), systemFree_(std::move(free)) {}

MemoryPool::~MemoryPool() {
  freeIdle(requests_ + 1);
}

std::size_t MemoryPool::sizeClass(std::size_t bytes) {
  if (bytes > kLargest) return 0;
  // Of particles by the million an eighth would be much.
  constexpr std::size_t kLarge = std::size_t{1} << 20;
  const std::size_t step = std::max(kAlignment, std::bit_ceil(bytes) / (bytes > kLarge ? 64 : 16));
  return (bytes + step - 1) / step * step;
}

void* MemoryPool::allocate(std::size_t bytes) {
  const std::size_t size = sizeClass(bytes);
  if (size == 0) return nullptr;
  const std::lock_guard lock(mutex_);
  ++requests_;
  std::vector<Idle>& blocks = idle_[size];
  void* memory = nullptr;
  if (!blocks.empty()) {
    memory = blocks.back().memory;
    blocks.pop_back();
  } else {
    // Only here, so that a steady state never gives back what it will need again.
    if (requests_ > kKeepRequests) freeIdle(requests_ - kKeepRequests);
    freeOutgrown(size);
    memory = systemAllocate_(size);
    if (memory == nullptr) {
      freeIdle(requests_ + 1);
      memory = systemAllocate_(size);
    }
    if (memory == nullptr) return nullptr;
    ++use_.allocations;
    use_.reserved += size;
    use_.peakReserved = std::max(use_.peakReserved, use_.reserved);
  }
  use_.inUse += size;
  use_.peak = std::max(use_.peak, use_.inUse);
  return memory;
}

void MemoryPool::release(void* memory, std::size_t bytes) noexcept {
  if (memory == nullptr) return;
  const std::size_t size = sizeClass(bytes);
  const std::lock_guard lock(mutex_);
  if (const auto lent = lent_.find(memory); lent != lent_.end()) {
    lent->second.released = size;
    return;
  }
  use_.inUse -= size;
  try {
    idle_[size].push_back({memory, requests_});
  } catch (const std::bad_alloc&) {  // not even to note it: the system has it back
    systemFree_(memory, size);
    use_.reserved -= size;
  }
}

std::shared_ptr<void> MemoryPool::lend(void* memory) {
  const std::lock_guard lock(mutex_);
  ++lent_[memory].times;
  return {memory, [this](void* lent) { endLoan(lent); }};
}

void MemoryPool::endLoan(void* memory) noexcept {
  std::size_t released = 0;
  {
    const std::lock_guard lock(mutex_);
    const auto lent = lent_.find(memory);
    if (--lent->second.times > 0) return;
    released = lent->second.released;
    lent_.erase(lent);
  }
  if (released > 0) release(memory, released);
}

MemoryUse MemoryPool::use() const {
  const std::lock_guard lock(mutex_);
  return use_;
}

void MemoryPool::freeOutgrown(std::size_t size) noexcept {
  // What grows, grows from smaller blocks. The larger ones stay, so that requests of several sizes that come
  // again and again do not drive one another out.
  constexpr std::size_t kIdleShare = 16;
  constexpr std::size_t kMatters = std::size_t{1} << 14;  // bytes; smaller blocks are not worth the trouble
  for (auto blocks = idle_.lower_bound(kMatters); blocks != idle_.end() && blocks->first < size; ++blocks)
    while (!blocks->second.empty() && (use_.reserved - use_.inUse) > use_.inUse / kIdleShare) {
      systemFree_(blocks->second.back().memory, blocks->first);
      blocks->second.pop_back();
      use_.reserved -= blocks->first;
    }
}

void MemoryPool::freeIdle(std::uint64_t releasedBefore) noexcept {
  for (auto& [size, blocks] : idle_) {
    std::erase_if(blocks, [&, size = size](const Idle& block) {
      if (block.since >= releasedBefore) return false;
      systemFree_(block.memory, size);
      use_.reserved -= size;
      return true;
    });
  }
}

std::string describeBytes(std::size_t bytes) {
  constexpr const char* kUnits[] = {"KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  if (bytes < 1024) return fmt::format("{} bytes", bytes);
  double value = static_cast<double>(bytes) / 1024;
  int unit = 0;
  for (; value >= 1024; value /= 1024) ++unit;
  return fmt::format("{} bytes ({:.1f} {})", bytes, value, kUnits[unit]);
}

}  // namespace weir
