// Keeps released blocks for the next request of the same size class, so that the steady state of a simulation
// asks the system for no memory. Both back ends use it; they differ in where the blocks come from.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/device.h"

namespace WEIR_API weir {

/// A block may be handed out again as soon as it is released: on CUDA that is sound because all work of a
/// device stands on one stream. Safe to use from several threads.
class MemoryPool {
 public:
  using Allocate = std::function<void*(std::size_t bytes)>;  ///< null if there is no memory
  using Free = std::function<void(void* memory, std::size_t bytes)>;

  MemoryPool(Allocate allocate, Free free);
  ~MemoryPool();
  MemoryPool(const MemoryPool&) = delete;
  MemoryPool& operator=(const MemoryPool&) = delete;

  /// Null for 0 bytes, and where the system has no memory even after all idle blocks went back to it.
  void* allocate(std::size_t bytes);
  /// `bytes` as asked for.
  void release(void* memory, std::size_t bytes) noexcept;
  /// A released block that is lent stays in use until all results of this for it are gone; they must not
  /// outlive the pool.
  std::shared_ptr<void> lend(void* memory);
  MemoryUse use() const;

  /// What a request really takes: multiples of 256 bytes, in eight steps for every doubling up to 1 MiB and
  /// in 32 beyond, so that at most an eighth or a 32nd is wasted. 0 if the number cannot be a size at all.
  static std::size_t sizeClass(std::size_t bytes);

 private:
  struct Idle {
    void* memory;
    std::uint64_t since;  // number of the request before which it was released
  };

  struct Lent {
    int times = 0;
    std::size_t released = 0;  // the size, once it has been released
  };

  void endLoan(void* memory) noexcept;
  /// Gives back idle blocks below `size` as long as more than a sixteenth of what is in use is idle.
  void freeOutgrown(std::size_t size) noexcept;
  void freeIdle(std::uint64_t releasedBefore) noexcept;

  Allocate systemAllocate_;
  Free systemFree_;
  mutable std::mutex mutex_;
  std::map<std::size_t, std::vector<Idle>> idle_;  // by size class
  std::map<void*, Lent> lent_;
  std::uint64_t requests_ = 0;
  MemoryUse use_;
};

/// "1234567 bytes (1.2 MiB)".
std::string describeBytes(std::size_t bytes);

}  // namespace weir
