// sortByCell of few particles on CUDA: all its passes in one kernel, by a cluster of blocks in shared memory.
// Included by cell_sort.inl where nvcc compiles.
//
// The passes are short where there are few particles, and six kernels, a copy and a fill take longer to start
// than to run. So does a barrier of the cluster, which waits for all that its threads have written. Hence
// each block finds the cells of a part of the particles, and tells them to all blocks; after the only barrier
// each sorts all of them in its own shared memory, and moves those whose cells it has found.
#pragma once

#include "framework/base/api.h"
#include "framework/compute/kernel_facts.h"
#include "framework/compute/kernel_overlap.h"

namespace WEIR_API weir {
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

// A barrier of the cluster in two halves.

/// Shows the others that this block has begun, and nothing that it has written.
__device__ inline void showBegun() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  asm volatile("barrier.cluster.arrive.relaxed;" ::: "memory");
#endif
}
/// Shows what has been written to shared memory, of other blocks, too.
__device__ inline void showWritten() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  asm volatile("barrier.cluster.arrive.release;" ::: "memory");
#endif
}
/// Waits until all have shown it.
__device__ inline void awaitOthers() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  asm volatile("barrier.cluster.wait.acquire;" ::: "memory");
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

/// The sum of `value` over the threads before this one.
__device__ inline int sumBefore(int value) {
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
  const int before = __shfl_sync(~0u, ofWarps, warp > 0 ? warp - 1 : 0);
  return (warp > 0 ? before : 0) + inclusive - value;
}

/// Numbers below 65536 in shared memory, two in a word. A thread scans an odd number of words, so that
/// threads are in different banks.
struct PackedCounts {
  unsigned* words;
  int ofThread;

  __device__ int operator[](int k) const { return static_cast<int>(words[k / 2] >> 16 * (k % 2) & 0xffffu); }
  /// Returns what it was before.
  __device__ int increase(int k) const {
    return static_cast<int>(::atomicAdd(words + k / 2, 1u << 16 * (k % 2)) >> 16 * (k % 2) & 0xffffu);
  }
  /// Each becomes the sum of all before it.
  __device__ void scan() const {
    unsigned* const own = words + static_cast<int>(threadIdx.x) * ofThread;
    unsigned sum = 0;
    for (int k = 0; k < ofThread; ++k) sum += (own[k] & 0xffffu) + (own[k] >> 16);
    unsigned before = static_cast<unsigned>(sumBefore(static_cast<int>(sum)));
    for (int k = 0; k < ofThread; ++k) {
      const unsigned low = own[k] & 0xffffu, high = own[k] >> 16;
      own[k] = before | (before + low) << 16;
      before += low + high;
    }
  }
};

/// What a block holds: where cells begin, then for each particle its cell, and the particles cell by cell.
struct SortInBlock {
  static constexpr int kMaxCells = 0xffff;  // and the dropped

  WEIR_HD static int wordsOfThread(int cells) { return (cells / 2 + kSortBlock) / kSortBlock | 1; }
  static unsigned bytes(int cells) {
    return static_cast<unsigned>(wordsOfThread(cells)) * kSortBlock * sizeof(unsigned) +
           2 * kFewToSort * sizeof(std::uint16_t);
  }

  PackedCounts starts;
  std::uint16_t *cell, *members;

  __device__ SortInBlock(unsigned* memory, int cells) : starts{memory, wordsOfThread(cells)} {
    cell = reinterpret_cast<std::uint16_t*>(memory + starts.ofThread * kSortBlock);
    members = cell + kFewToSort;
  }
  __device__ void clear() const {
    for (int k = 0; k < starts.ofThread; ++k) starts.words[k * kSortBlock + threadIdx.x] = 0;
  }
  /// By the cells of n particles; those of a cell are in no particular order.
  __device__ void sort(int n) const {
    constexpr int kTurns = kFewToSort / kSortBlock;
    const int thread = static_cast<int>(threadIdx.x);
    int rank[kTurns];
#pragma unroll
    for (int t = 0; t < kTurns; ++t)
      if (const int i = t * kSortBlock + thread; i < n) rank[t] = starts.increase(cell[i]);
    __syncthreads();
    starts.scan();
    __syncthreads();
#pragma unroll
    for (int t = 0; t < kTurns; ++t)
      if (const int i = t * kSortBlock + thread; i < n)
        members[starts[cell[i]] + rank[t]] = static_cast<std::uint16_t>(i);
    __syncthreads();
  }
  /// Of particle i: behind those of its cell that have a lower index.
  __device__ int place(int i, int begin, int end) const {
    int place = begin;
    for (int m = begin; m < end; ++m) place += members[m] < i ? 1 : 0;
    return place;
  }
};

template <class Key, class Moved>
__global__ void WEIR_CLUSTER_OF(kSortCluster) __launch_bounds__(kSortBlock)
    sortInClusterKernel(Count count, const __grid_constant__ CountInCells<Key> counting,
                        const __grid_constant__ OrderInCells<Moved> ordering, int* kept) {
  extern __shared__ unsigned memory[];
  showBegun();
  const int thread = static_cast<int>(threadIdx.x), block = static_cast<int>(blockIdx.x);
  const int cells = counting.cells;
  const SortInBlock all(memory, cells);
  all.clear();
  waitForPriorKernel();
  const int n = static_cast<int>(count.get()), inBlock = (n + kSortCluster - 1) / kSortCluster;
  const int i = block * inBlock + thread;
  const bool isThere = thread < inBlock && i < n;
  const int cell = isThere ? counting.cellOf(i) : 0;
  awaitOthers();
  if (isThere)
    for (int b = 0; b < kSortCluster; ++b) *ofBlock(all.cell + i, b) = static_cast<std::uint16_t>(cell);
  showWritten();
  awaitOthers();
  all.sort(n);
  for (int c = block * kSortBlock + thread; c <= cells; c += kFewToSort) counting.counts[c] = all.starts[c];
  if (block == 0 && thread == 0) *kept = all.starts[cells];
  if (isThere) {
    const int place = all.place(i, all.starts[cell], cell < cells ? all.starts[cell + 1] : n);
    if (cell < cells)
      ordering.put(place, i);
    else
      ordering.order[place] = i;
  }
  triggerDependentKernel();
}

/// Whether it has sorted them.
template <class Key, class Moved>
bool sortFew(CudaDevice& device, Count count, const CountInCells<Key>& counting,
             const OrderInCells<Moved>& ordering, int* kept) {
  if (count.bound > kFewToSort || counting.cells > SortInBlock::kMaxCells) return false;
  constexpr std::string_view kName = "sortInCluster";
  const unsigned bytes = SortInBlock::bytes(counting.cells);
  beginLaunch(device, kName);
  const auto* kernel = reinterpret_cast<const void*>(sortInClusterKernel<Key, Moved>);
  if (!mayCluster(device, kernel, kSortCluster, kSortBlock, bytes)) return false;
  const KernelScope scope(device.profiler(), kName);
  device.check(
      submitKernel(device.launches(), sortInClusterKernel<Key, Moved>,
                   {kSortCluster, kSortBlock, bytes, {true}}, steadyCount(count), counting, ordering, kept),
      kName);
  return true;
}

}  // namespace detail
}  // namespace weir
