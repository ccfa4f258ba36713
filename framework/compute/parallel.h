// The parallel primitives, one signature for both back ends.
//
//   parallelFor      f(i) for every i; parallelForWithScratch: f(i, scratch); parallelForTeams: f(i, team)
//   reduce           op over f(i), the result stays on the device
//   exclusiveScan    prefix sums of ints
//   stableSortByKey  radix sort of (key, value) pairs
//   compact          indices of the elements that a predicate keeps, in order
//   cellSort         counting sort by cell (cell_sort.h)
//
// Kernels are functors with a const operator() marked WEIR_HD; they hold ArrayViews and plain numbers, by
// value. A template that launches them takes its back end as a template parameter `Backend` and is
// compiled twice, see `weir_add_dual_sources` in cmake/. None of these waits for the device.
#pragma once

#include <bit>
#include <cstdint>
#include <string_view>

#include "framework/base/api.h"
#include "framework/compute/array.h"
#include "framework/compute/standing.h"

namespace WEIR_API weir {

/// How many elements a launch covers. A simulation that gains and loses particles on the device knows only an
/// upper bound on the host; the exact number then stands in device memory and kernels stop there.
struct Count {
  std::int64_t bound = 0;
  const int* exact = nullptr;  ///< on the device, at most bound; null if bound is exact

  Count() = default;
  Count(std::int64_t n) : bound(n) {}
  Count(std::int64_t upperBound, const int* onDevice) : bound(upperBound), exact(onDevice) {}

  WEIR_HD std::int64_t get() const { return exact != nullptr ? *exact : bound; }
};

/// Calls f(i) for every i in [0, count). The calls are independent: none reads what another writes, except
/// through atomicAdd.
template <class F>
void parallelFor(CpuBackend& device, std::string_view name, Count count, const F& f);
template <class F>
void parallelFor(CudaDevice& device, std::string_view name, Count count, const F& f);

/// Numbers of one call's own in the fastest memory there is, undefined at first.
struct Scratch {
  int* data = nullptr;
  int stride = 1;

  WEIR_HD int& operator[](int k) const { return data[k * stride]; }
};
inline constexpr int kMaxScratch = 384;  // numbers

/// Calls f(i, scratch) for every i in [0, count), with `numbers` (at most kMaxScratch) of scratch memory
/// each.
template <class F>
void parallelForWithScratch(CpuBackend& device, std::string_view name, Count count, int numbers, const F& f);
template <class F>
void parallelForWithScratch(CudaDevice& device, std::string_view name, Count count, int numbers, const F& f);

/// The threads that share a call: one on the CPU and where there are calls enough. Each makes the whole call
/// but for what it leaves to the others, and all must come to the same questions below.
struct Team {
  static constexpr int kMax = 32;  // a warp

  int lane = 0, size = 1;  ///< this thread among them
  int first = 0;           ///< of them among the threads that run in step
  bool spare = false;      ///< whether another team makes this call, too

  /// Σ value over the team, the same for all, in an order that depends on the size alone.
  WEIR_HD float sum(float value) const;
  /// All bits that one of them has.
  WEIR_HD int unite(int bits) const;
  /// Bit l is the answer of lane l.
  WEIR_HD unsigned ask(bool answer) const;
};

/// How a launch divides its calls.
struct TeamPlan {
  int size;          ///< of a team: a power of two up to Team::kMax
  std::int64_t few;  ///< launches with a larger bound have teams of one
};

/// Calls f(i, team) for every i in [0, count). On CUDA, where F::kInStep is true, all teams of a warp call it
/// together: those behind the last element get the last one with Team::spare set, and must not write.
template <TeamPlan kPlan, class F>
void parallelForTeams(CpuBackend& device, std::string_view name, Count count, const F& f);
template <TeamPlan kPlan, class F>
void parallelForTeams(CudaDevice& device, std::string_view name, Count count, const F& f);

/// Writes op(identity, f(0), f(1), …) to *result (device memory). T is trivially copyable, op associative and
/// commutative up to rounding, with identity its neutral element. The order of combination is fixed, so the
/// result depends on the exact count and the values alone: not on the bound, the number of threads, or the
/// run.
template <class T, class F, class Op>
void reduce(CpuBackend& device, std::string_view name, Count count, T identity, const F& f, const Op& op,
            T* result);
template <class T, class F, class Op>
void reduce(CudaDevice& device, std::string_view name, Count count, T identity, const F& f, const Op& op,
            T* result);

/// out[i] = in[0] + … + in[i-1]; in and out may be the same. `n` elements.
void exclusiveScan(CpuBackend& device, ArrayView<const int> in, ArrayView<int> out, std::int64_t n);
void exclusiveScan(CudaDevice& device, ArrayView<const int> in, ArrayView<int> out, std::int64_t n);

/// Sorts n pairs by ascending key; equal keys keep their order.
void stableSortByKey(CpuBackend& device, ArrayView<std::uint32_t> keys, ArrayView<int> values,
                     std::int64_t n);
void stableSortByKey(CudaDevice& device, ArrayView<std::uint32_t> keys, ArrayView<int> values,
                     std::int64_t n);
void stableSortByKey(CpuBackend& device, ArrayView<std::uint64_t> keys, ArrayView<int> values,
                     std::int64_t n);
void stableSortByKey(CudaDevice& device, ArrayView<std::uint64_t> keys, ArrayView<int> values,
                     std::int64_t n);

/// indices[k] = the k-th i in [0, count) with keep(i); *kept (device memory) = how many; it may stand where
/// the exact count does. Needs indices.size >= bound. keep(i) is asked once on CUDA and twice on the CPU, and
/// must give the same answer.
template <class Keep>
void compact(CpuBackend& device, std::string_view name, Count count, const Keep& keep, ArrayView<int> indices,
             int* kept);
template <class Keep>
void compact(CudaDevice& device, std::string_view name, Count count, const Keep& keep, ArrayView<int> indices,
             int* kept);

WEIR_HD inline int countBits(unsigned bits) {
#ifdef __CUDA_ARCH__
  return __popc(bits);
#else
  return std::popcount(bits);
#endif
}

namespace detail {
/// Of `size` threads from `first` on.
WEIR_HD inline unsigned laneBits(int first, int size) {
  return (size == Team::kMax ? ~0u : (1u << size) - 1) << first;
}
}  // namespace detail

WEIR_HD inline float Team::sum(float value) const {
#ifdef __CUDA_ARCH__
  for (int step = size / 2; step > 0; step /= 2)
    value += __shfl_xor_sync(detail::laneBits(first, size), value, step);
#endif
  return value;
}

WEIR_HD inline unsigned Team::ask(bool answer) const {
#ifdef __CUDA_ARCH__
  const unsigned all = detail::laneBits(first, size);
  return (__ballot_sync(all, answer) & all) >> first;
#else
  return answer ? 1u : 0u;
#endif
}

WEIR_HD inline int Team::unite(int bits) const {
#ifdef __CUDA_ARCH__
  for (int step = size / 2; step > 0; step /= 2)
    bits |= __shfl_xor_sync(detail::laneBits(first, size), bits, step);
#endif
  return bits;
}

/// Adds to *counter and returns what it held before; safe between the threads of one kernel.
WEIR_HD inline int atomicAdd(int* counter, int amount);

}  // namespace weir

#include "framework/compute/parallel_cpu.inl"
#ifdef __CUDACC__
#include "framework/compute/parallel_cuda.inl"
#endif
