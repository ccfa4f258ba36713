// sortByCell of few particles on CUDA: all its passes in one kernel of one block, in shared memory. Included
// by cell_sort.inl where nvcc compiles.
//
// The passes are short where there are few particles, and six kernels, a copy and a fill take longer to start
// than to run. A block on one multiprocessor needs a barrier between passes instead, and what they leave for
// each other stands in its shared memory.
#pragma once

#include "framework/compute/kernel_facts.h"

namespace weir {
namespace detail {

inline constexpr int kSortBlock = 1024;              // threads
inline constexpr std::int64_t kFewToSort = 1 << 13;  // particles
inline constexpr int kCellsByThread = 16;            // that a thread sums at a time
inline constexpr int kCellsAtOnce = 4;               // that it reads
inline constexpr int kCellsByBlock = kSortBlock * kCellsByThread;

/// Where the count of a cell stands in shared memory. A thread sums a stretch of cells, four at a time; in
/// their own order, the stretches of threads side by side would begin in the same two banks.
__device__ inline int sharedPlace(int cell) {
  return cell ^ (cell >> 5 & 3) << 2;
}

/// The sum of `value` over the threads before this one, and of all in `total`.
__device__ inline int sumBefore(int value, int& total) {
  constexpr int kWarps = kSortBlock / kWarp;
  static_assert(kWarps == kWarp);
  __shared__ int sums[kWarps];
  const int lane = static_cast<int>(threadIdx.x) % kWarp, warp = static_cast<int>(threadIdx.x) / kWarp;
  int inclusive = value;
  for (int step = 1; step < kWarp; step *= 2) {
    const int left = __shfl_up_sync(~0u, inclusive, step);
    if (lane >= step) inclusive += left;
  }
  if (lane == kWarp - 1) sums[warp] = inclusive;
  __syncthreads();
  int ofWarps = sums[lane];
  for (int step = 1; step < kWarp; step *= 2) {
    const int left = __shfl_up_sync(~0u, ofWarps, step);
    if (lane >= step) ofWarps += left;
  }
  total = __shfl_sync(~0u, ofWarps, kWarp - 1);
  const int before = __shfl_sync(~0u, ofWarps, warp > 0 ? warp - 1 : 0);
  __syncthreads();
  return (warp > 0 ? before : 0) + inclusive - value;
}

/// counts[sharedPlace(c)] becomes the sum of those of all cells before c, for c < n; start gets them, too.
/// `counts` has room for a multiple of kCellsByBlock.
__device__ inline void scanCounts(int* counts, int n, int* start) {
  int before = 0;
  for (int first = 0; first < n; first += kCellsByBlock) {
    const int own = first + static_cast<int>(threadIdx.x) * kCellsByThread;
    int4 four[kCellsByThread / kCellsAtOnce];
    int sum = 0;
#pragma unroll
    for (int k = 0; k < kCellsByThread / kCellsAtOnce; ++k) {
      four[k] = *reinterpret_cast<const int4*>(counts + sharedPlace(own + k * kCellsAtOnce));
      sum += four[k].x + four[k].y + four[k].z + four[k].w;
    }
    int total;
    int at = before + sumBefore(sum, total);
#pragma unroll
    for (int k = 0; k < kCellsByThread / kCellsAtOnce; ++k) {
      const int4 count = four[k];
      const int4 sums{at, at + count.x, at + count.x + count.y, at + count.x + count.y + count.z};
      at = sums.w + count.w;
      const int cell = own + k * kCellsAtOnce;
      *reinterpret_cast<int4*>(counts + sharedPlace(cell)) = sums;
      if (cell + kCellsAtOnce <= n) {
        *reinterpret_cast<int4*>(start + cell) = sums;
      } else {
        if (cell < n) start[cell] = sums.x;
        if (cell + 1 < n) start[cell + 1] = sums.y;
        if (cell + 2 < n) start[cell + 2] = sums.z;
      }
    }
    before += total;
  }
  __syncthreads();
}

inline constexpr int kRankShift = 16;
inline constexpr int kMostCellsOfBlock = (1 << kRankShift) - 1;

/// The cells with one for the dropped, in whole stretches of all threads.
WEIR_HD inline int countedCells(int cells) {
  return (cells + kCellsByBlock) / kCellsByBlock * kCellsByBlock;
}

template <class Key>
__global__ void __launch_bounds__(kSortBlock)
    sortInOneBlockKernel(Count count, const __grid_constant__ CountInCells<Key> counting,
                         const __grid_constant__ OrderInCells ordering, int* kept) {
  extern __shared__ int4 memory[];
  int* const counts = reinterpret_cast<int*>(memory);
  const int n = static_cast<int>(count.get()), thread = static_cast<int>(threadIdx.x);
  const int cells = counting.cells, counted = countedCells(cells);
  int* const provisional = counts + counted;
  int* const own = provisional + n;  // cell and rank of each particle, for its thread alone
  for (int c = thread; c < counted / kCellsAtOnce; c += kSortBlock) memory[c] = int4{0, 0, 0, 0};
  __syncthreads();
#pragma unroll 1  // keys are long
  for (int i = thread; i < n; i += kSortBlock) {
    const int cell = counting.cellOf(i);
    own[i] = cell | ::atomicAdd(counts + sharedPlace(cell), 1) << kRankShift;
  }
  __syncthreads();
  scanCounts(counts, cells + 1, counting.counts.data);
  const auto startOf = [counts](int cell) { return counts[sharedPlace(cell)]; };
  for (int i = thread; i < n; i += kSortBlock)
    provisional[startOf(own[i] & kMostCellsOfBlock) + (own[i] >> kRankShift)] = i;
  __syncthreads();
#pragma unroll 1
  for (int i = thread; i < n; i += kSortBlock) {
    const int cell = own[i] & kMostCellsOfBlock, rank = own[i] >> kRankShift, begin = startOf(cell);
    if (cell == cells)
      ordering.order[begin + rank] = i;
    else
      ordering.place(i, rank, provisional + begin, begin, startOf(cell + 1) - begin);
  }
  if (thread == 0) *kept = startOf(cells);
}

/// Whether it has sorted them.
template <class Key>
bool sortFew(CudaDevice& device, Count count, const CountInCells<Key>& counting, const OrderInCells& ordering,
             int* kept) {
  const bool aligned = reinterpret_cast<std::uintptr_t>(counting.counts.data) % sizeof(int4) == 0;
  if (count.bound > kFewToSort || counting.cells > kMostCellsOfBlock || !aligned) return false;
  const Count steady = steadyCount(count);
  const unsigned bytes =
      (static_cast<unsigned>(countedCells(counting.cells)) + 2 * static_cast<unsigned>(steady.bound)) *
      sizeof(int);
  constexpr std::string_view kName = "sortInOneBlock";
  beginLaunch(device, kName);
  if (!mayShare(device, reinterpret_cast<const void*>(sortInOneBlockKernel<Key>), bytes)) return false;
  const KernelScope scope(device.profiler(), kName);
  device.check(submitKernel(device.launches(), sortInOneBlockKernel<Key>, {1, kSortBlock, bytes}, steady,
                            counting, ordering, kept),
               kName);
  return true;
}

}  // namespace detail
}  // namespace weir
