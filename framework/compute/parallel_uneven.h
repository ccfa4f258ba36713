// Launches whose elements take microseconds each, and some of them many times as long as others: triangles
// near a particle, the way of a particle along a wall.
#pragma once

#include <type_traits>

#include "framework/base/api.h"
#include "framework/compute/parallel.h"

namespace WEIR_API weir {

/// Calls f(begin, end) for ranges that together are [0, count), few elements at a time. How the ranges are
/// cut depends on the number of threads, so results should not depend on it.
template <class F>
void forEachUnevenRange(CpuBackend& device, std::string_view name, Count count, const F& f) {
  constexpr std::int64_t kTurns = 32;  // of a thread
  constexpr std::int64_t kMin = 4, kMax = 64;
  const KernelScope scope(device.profiler(), name);
  const std::int64_t n = count.get();
  detail::forRanges(device, n, std::clamp(n / (kTurns * device.threads()), kMin, kMax), f);
}

/// parallelFor, or with a plan parallelForTeams, for few and costly elements. Where parallelFor would keep
/// them on one thread of the CPU or give thousands to each, all threads take a few at a time.
template <class Backend, class F>
void parallelForUneven(Backend& device, std::string_view name, Count count, const F& f) {
  if constexpr (std::is_same_v<Backend, CudaDevice>) {
    parallelFor(device, name, count, f);
  } else {
    forEachUnevenRange(device, name, count, [&f](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) f(i);
    });
  }
}
template <TeamPlan kPlan, class Backend, class F>
void parallelForUneven(Backend& device, std::string_view name, Count count, const F& f) {
  if constexpr (std::is_same_v<Backend, CudaDevice>)
    parallelForTeams<kPlan>(device, name, count, f);
  else
    parallelForUneven(device, name, count, [&f](std::int64_t i) { f(i, Team{}); });
}

}  // namespace weir
