// What needs oneTBB. The thread sanitizer leaves this file alone: what TBB's headers share with its library,
// into which the sanitizer cannot look, would seem to be races.
#include "framework/compute/cpu_threads.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <optional>

namespace weir {

struct CpuThreads::Impl {
  explicit Impl(int count) : arena(count) {
    // Only ever raises the limit of the process, so devices with other numbers of threads are not affected.
    if (count > tbb::info::default_concurrency()) {
      moreThanCores.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count));
    }
  }

  std::optional<tbb::global_control> moreThanCores;
  tbb::task_arena arena;
};

CpuThreads::CpuThreads(int count)
    : count_(count > 0 ? count : tbb::info::default_concurrency()), impl_(std::make_unique<Impl>(count_)) {}

CpuThreads::~CpuThreads() = default;

void CpuThreads::runUnordered(std::int64_t n, void (*task)(void* context, std::int64_t k), void* context) {
  using Range = tbb::blocked_range<std::int64_t>;
  impl_->arena.execute([=] {
    tbb::parallel_for(
        Range(0, n),
        [=](const Range& range) {
          for (std::int64_t k = range.begin(); k < range.end(); ++k) task(context, k);
        },
        tbb::simple_partitioner());
  });
}

}  // namespace weir
