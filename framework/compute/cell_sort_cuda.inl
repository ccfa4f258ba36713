// sortByCell of few particles on CUDA: all its passes in one kernel, by a cluster of blocks in shared memory.
// Included by cell_sort.inl where nvcc compiles.
//
// The passes are short where there are few particles, and six kernels, a copy and a fill take longer to start
// than to run. Eight blocks that reach each other's shared memory have a thread for each particle, a barrier
// of their own between passes, and what they leave for each other stands there.
#pragma once

#include "framework/compute/kernel_facts.h"
#include "framework/compute/kernel_overlap.h"

namespace weir {
namespace detail {

// Devices that know no clusters have no code for the kernel below, and never launch it.
#if !defined(__CUDA_ARCH__) || __CUDA_ARCH__ >= 900
#define WEIR_CLUSTER_OF(blocks) __cluster_dims__(blocks, 1, 1)
#else
#define WEIR_CLUSTER_OF(blocks)
#endif

inline constexpr int kSortBlock = 1024;  // threads
inline constexpr int kSortCluster = 8;   // blocks, as many as any such device allows
inline constexpr int kFewToSort = kSortCluster * kSortBlock;

/// What one has written to shared or global memory is there for all of the cluster from here on.
__device__ inline void meetCluster() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  asm volatile("barrier.cluster.arrive.release;\nbarrier.cluster.wait.acquire;" ::: "memory");
#endif
}

/// What stands at the same place in the shared memory of another block of the cluster.
template <class T>
__device__ T* ofBlock(T* here, [[maybe_unused]] int block) {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  T* there;
  asm("mapa.u64 %0, %1, %2;" : "=l"(there) : "l"(here), "r"(block));
  return there;
#else
  return here;
#endif
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

/// An array in the shared memory of all blocks of the cluster, so much of it in each.
struct ClusterArray {
  int* here;
  int inBlock;

  __device__ int* at(int k) const { return ofBlock(here, k / inBlock) + k % inBlock; }
};

/// Of the counts of `cells` cells and of the dropped, how many are in each block: in whole rows of its
/// threads.
WEIR_HD inline int countsInBlock(int cells) {
  return (cells + kFewToSort) / kFewToSort * kSortBlock;
}

/// counts.at(c) becomes the sum of those of all cells before c.
__device__ inline void scanCounts(const ClusterArray& counts) {
  __shared__ int totals[kSortCluster];  // of the blocks
  const int thread = static_cast<int>(threadIdx.x), block = static_cast<int>(blockIdx.x);
  const int perThread = counts.inBlock / kSortBlock;
  int* const own = counts.here + thread * perThread;
  int sum = 0, total;
  for (int k = 0; k < perThread; ++k) sum += own[k];
  int before = sumBefore(sum, total);
  if (thread < kSortCluster) *ofBlock(totals + block, thread) = total;
  meetCluster();
  for (int b = 0; b < block; ++b) before += totals[b];
  for (int k = 0; k < perThread; ++k) {
    const int here = own[k];
    own[k] = before;
    before += here;
  }
  meetCluster();
}

template <class Key, class Moved>
__global__ void WEIR_CLUSTER_OF(kSortCluster) __launch_bounds__(kSortBlock)
    sortInClusterKernel(Count count, const __grid_constant__ CountInCells<Key> counting,
                        const __grid_constant__ OrderInCells<Moved> ordering, int* kept) {
  awaitWhatIsBefore();
  extern __shared__ int memory[];
  const int thread = static_cast<int>(threadIdx.x), block = static_cast<int>(blockIdx.x);
  const int i = block * kSortBlock + thread, cells = counting.cells, inBlock = countsInBlock(cells);
  const ClusterArray counts{memory, inBlock}, provisional{memory + inBlock, kSortBlock};
  for (int c = thread; c < inBlock; c += kSortBlock) counts.here[c] = 0;
  const bool isThere = i < count.get();
  const int cell = isThere ? counting.cellOf(i) : 0;
  meetCluster();
  int rank = 0;
  if (isThere) rank = ::atomicAdd(counts.at(cell), 1);
  meetCluster();
  scanCounts(counts);
  int begin = 0;
  if (isThere) {
    begin = *counts.at(cell);
    *provisional.at(begin + rank) = i;
  }
  for (int c = thread, first = block * inBlock; c < inBlock && first + c <= cells; c += kSortBlock)
    counting.counts[first + c] = counts.here[c];
  if (i == 0) *kept = *counts.at(cells);
  meetCluster();
  if (isThere && cell == cells) {
    ordering.order[begin + rank] = i;
  } else if (isThere) {
    const int size = *counts.at(cell + 1) - begin;
    if (size <= ordering.kCrowded) {
      int place = begin;
      for (int m = begin; m < begin + size; ++m) place += *provisional.at(m) < i ? 1 : 0;
      ordering.put(place, i);
    } else if (rank == 0) {
      for (int m = begin; m < begin + size; ++m) ordering.order[m] = *provisional.at(m);
      ordering.sortCell(begin, size);
    }
  }
  meetCluster();  // others may still read what is this block's
  letNextBegin();
}

/// Whether it has sorted them.
template <class Key, class Moved>
bool sortFew(CudaDevice& device, Count count, const CountInCells<Key>& counting,
             const OrderInCells<Moved>& ordering, int* kept) {
  if (count.bound > kFewToSort) return false;
  constexpr std::string_view kName = "sortInCluster";
  const unsigned bytes = static_cast<unsigned>(countsInBlock(counting.cells) + kSortBlock) * sizeof(int);
  beginLaunch(device, kName);
  const auto* kernel = reinterpret_cast<const void*>(sortInClusterKernel<Key, Moved>);
  if (!mayCluster(device, kernel, kSortCluster, kSortBlock, bytes)) return false;
  const KernelScope scope(device.profiler(), kName);
  device.check(
      submitKernel(device.launches(), sortInClusterKernel<Key, Moved>,
                   {kSortCluster, kSortBlock, bytes, true}, steadyCount(count), counting, ordering, kept),
      kName);
  return true;
}

}  // namespace detail
}  // namespace weir
