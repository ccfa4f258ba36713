// The threads of the CPU back end. Their implementation alone knows oneTBB.
#pragma once

#include <cstdint>
#include <memory>

#include "framework/base/api.h"

namespace WEIR_API weir {

class CpuThreads {
 public:
  /// 0 means one for every core that the process may use.
  explicit CpuThreads(int count);
  ~CpuThreads();

  int count() const { return count_; }

  /// Calls task(context, k) once for every k in [0, n), on all threads; throws what a task throws.
  void run(std::int64_t n, void (*task)(void* context, std::int64_t k), void* context);

 private:
  struct Impl;
  void runUnordered(std::int64_t n, void (*task)(void* context, std::int64_t k), void* context);

  int count_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace weir
