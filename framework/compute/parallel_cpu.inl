// The parallel primitives on the CPU. Included by parallel.h.
#pragma once

#include <algorithm>
#include <atomic>

#include "framework/base/api.h"

namespace WEIR_API weir {
namespace detail {

/// Launches up to this many elements run on the calling thread: waking the others would take longer.
inline constexpr std::int64_t kSerialElements = 1024;

/// The block of elements that a reduction or a compaction treats as one; fixed, because results depend on it.
inline constexpr std::int64_t kCpuBlock = 4096;

/// About eight ranges for every thread, so that uneven work spreads; whole cache lines, so that threads
/// do not write to the same ones.
inline std::int64_t cpuGrain(std::int64_t n, int threads) {
  if (n <= kSerialElements) return kSerialElements;
  const std::int64_t even = n / (std::int64_t{threads} * 8);
  return std::clamp<std::int64_t>(even / 64 * 64, 256, 8192);
}

/// body(begin, end) on all threads; the body is a template argument, so its loop stays visible to the
/// optimiser.
template <class Body>
void forRanges(CpuBackend& device, std::int64_t n, std::int64_t grain, const Body& body) {
  device.forRanges(
      n, grain,
      [](void* context, std::int64_t begin, std::int64_t end) {
        (*static_cast<const Body*>(context))(begin, end);
      },
      const_cast<Body*>(&body));
}

/// op over f(begin) … f(end-1). Eight interleaved partial results break the chain of dependent operations
/// and are combined as a tree; that order is part of the result.
template <class T, class F, class Op>
T reduceRange(std::int64_t begin, std::int64_t end, const T& identity, const F& f, const Op& op) {
  constexpr int kLanes = 8;
  T lane[kLanes] = {identity, identity, identity, identity, identity, identity, identity, identity};
  std::int64_t i = begin;
  for (; i + kLanes <= end; i += kLanes) {
    for (int l = 0; l < kLanes; ++l) lane[l] = op(lane[l], static_cast<T>(f(i + l)));
  }
  for (int l = 0; i < end; ++i, ++l) lane[l] = op(lane[l], static_cast<T>(f(i)));
  for (int width = kLanes / 2; width > 0; width /= 2) {
    for (int l = 0; l < width; ++l) lane[l] = op(lane[l], lane[l + width]);
  }
  return lane[0];
}

}  // namespace detail

template <class F>
void parallelFor(CpuBackend& device, std::string_view name, Count count, const F& f) {
  const KernelScope scope(device.profiler(), name);
  const std::int64_t n = count.get();
  detail::forRanges(device, n, detail::cpuGrain(n, device.threads()),
                    [&](std::int64_t begin, std::int64_t end) {
                      // A copy whose address nobody has: the optimiser knows that no store changes the
                      // pointers in it.
                      const F kernel = f;
    // The elements of a launch are independent, so their loop may be vectorised without checks for overlap.
#if defined(__GNUC__) && !defined(__clang__) && !defined(__CUDACC__)
#pragma GCC ivdep
#endif
                      for (std::int64_t i = begin; i < end; ++i) kernel(i);
                    });
}

template <class F>
void parallelForWithScratch(CpuBackend& device, std::string_view name, Count count, int numbers, const F& f) {
  WEIR_CHECK(numbers <= kMaxScratch);
  parallelFor(device, name, count, [&f](std::int64_t i) {
    int scratch[kMaxScratch];
    f(i, Scratch{scratch, 1});
  });
}

template <TeamPlan, class F>
void parallelForTeams(CpuBackend& device, std::string_view name, Count count, const F& f) {
  parallelFor(device, name, count, [&f](std::int64_t i) { f(i, Team{}); });
}

template <class T, class F, class Op>
void reduce(CpuBackend& device, std::string_view name, Count count, T identity, const F& f, const Op& op,
            T* result) {
  const KernelScope scope(device.profiler(), name);
  const std::int64_t n = count.get();
  if (n <= detail::kCpuBlock) {
    *result = detail::reduceRange(0, n, identity, f, op);
    return;
  }
  const std::int64_t blocks = (n - 1) / detail::kCpuBlock + 1;
  Array<T> partials(device, blocks);
  T* partial = partials.data();
  detail::forRanges(device, n, detail::kCpuBlock, [&](std::int64_t begin, std::int64_t end) {
    const F element = f;
    partial[begin / detail::kCpuBlock] = detail::reduceRange(begin, end, identity, element, op);
  });
  for (std::int64_t stride = 1; stride < blocks; stride *= 2) {
    for (std::int64_t b = 0; b + stride < blocks; b += 2 * stride)
      partial[b] = op(partial[b], partial[b + stride]);
  }
  *result = partial[0];
}

template <class Keep>
void compact(CpuBackend& device, std::string_view name, Count count, const Keep& keep, ArrayView<int> indices,
             int* kept) {
  const KernelScope scope(device.profiler(), name);
  WEIR_CHECK(indices.size >= count.bound);
  const std::int64_t n = count.get();
  const std::int64_t blocks = (n + detail::kCpuBlock - 1) / detail::kCpuBlock;
  Array<int> firsts(device, blocks);
  int* first = firsts.data();
  detail::forRanges(device, n, detail::kCpuBlock, [&](std::int64_t begin, std::int64_t end) {
    int keptHere = 0;
    for (std::int64_t i = begin; i < end; ++i) keptHere += keep(i) ? 1 : 0;
    first[begin / detail::kCpuBlock] = keptHere;
  });
  int total = 0;
  for (std::int64_t b = 0; b < blocks; ++b) {
    const int keptHere = first[b];
    first[b] = total;
    total += keptHere;
  }
  detail::forRanges(device, n, detail::kCpuBlock, [&](std::int64_t begin, std::int64_t end) {
    int* out = indices.data + first[begin / detail::kCpuBlock];
    for (std::int64_t i = begin; i < end; ++i) {
      if (keep(i)) *out++ = static_cast<int>(i);
    }
  });
  *kept = total;
}

WEIR_HD inline int atomicAdd(int* counter, int amount) {
#ifdef __CUDA_ARCH__
  return ::atomicAdd(counter, amount);
#else
  return std::atomic_ref<int>(*counter).fetch_add(amount, std::memory_order_relaxed);
#endif
}

}  // namespace weir
