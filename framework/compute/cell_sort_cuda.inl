// sortByCell of few particles on CUDA: all its passes in one kernel of one block. Included by cell_sort.inl
// where nvcc compiles.
//
// The passes are short where there are few particles, and six kernels, a copy and a fill take longer to start
// than to run. A block on one multiprocessor needs a barrier between passes instead.
#pragma once

#include "framework/compute/launch_queue.h"

namespace weir {
namespace detail {

inline constexpr int kSortBlock = 1024;              // threads
inline constexpr std::int64_t kFewToSort = 1 << 13;  // particles
inline constexpr std::int64_t kFewCells = 1 << 16;

/// values[k] becomes the sum of those before it, by all threads of the block. Each warp takes a stretch.
__device__ inline void scanInBlock(int* values, int n) {
  constexpr int kWarps = kSortBlock / kWarp;
  __shared__ int sums[kWarps];
  const int lane = static_cast<int>(threadIdx.x) % kWarp, warp = static_cast<int>(threadIdx.x) / kWarp;
  const int stretch = (n + kSortBlock - 1) / kSortBlock * kWarp;
  const int begin = warp * stretch, end = begin + stretch < n ? begin + stretch : n;
  int sum = 0;
  for (int k = begin + lane; k < end; k += kWarp) sum += values[k];
  for (int step = kWarp / 2; step > 0; step /= 2) sum += __shfl_xor_sync(~0u, sum, step);
  if (lane == 0) sums[warp] = sum;
  __syncthreads();
  int before = lane < warp ? sums[lane] : 0;
  for (int step = kWarp / 2; step > 0; step /= 2) before += __shfl_xor_sync(~0u, before, step);
  for (int first = begin; first < end; first += kWarp) {
    const int k = first + lane;
    const int value = k < end ? values[k] : 0;
    int inclusive = value;
    for (int step = 1; step < kWarp; step *= 2) {
      const int left = __shfl_up_sync(~0u, inclusive, step);
      if (lane >= step) inclusive += left;
    }
    if (k < end) values[k] = before + inclusive - value;
    before += __shfl_sync(~0u, inclusive, kWarp - 1);
  }
  __syncthreads();
}

template <class Key>
__global__ void __launch_bounds__(kSortBlock)
    sortInOneBlockKernel(Count count, const __grid_constant__ CountInCells<Key> counting,
                         const __grid_constant__ ScatterToCells scatter,
                         const __grid_constant__ OrderInCells ordering, int* kept) {
  const int n = static_cast<int>(count.get()), thread = static_cast<int>(threadIdx.x);
  const int starts = counting.cells + 1;
  int* const start = counting.counts.data;
  for (int c = thread; c < starts; c += kSortBlock) start[c] = 0;
  __syncthreads();
  for (int i = thread; i < n; i += kSortBlock) counting(i);
  __syncthreads();
  scanInBlock(start, starts);
  for (int i = thread; i < n; i += kSortBlock) scatter(i);
  __syncthreads();
  for (int k = thread; k < n; k += kSortBlock) ordering(k);
  if (thread == 0) *kept = start[counting.cells];
}

/// Whether it has sorted them.
template <class Key>
bool sortFew(CudaDevice& device, Count count, const CountInCells<Key>& counting,
             const ScatterToCells& scatter, const OrderInCells& ordering, int* kept) {
  if (count.bound > kFewToSort || counting.cells >= kFewCells) return false;
  constexpr std::string_view kName = "sortInOneBlock";
  const KernelScope scope(device.profiler(), kName);
  beginLaunch(device, kName);
  device.check(submitKernel(device.launches(), sortInOneBlockKernel<Key>, 1, kSortBlock, 0,
                            steadyCount(count), counting, scatter, ordering, kept),
               kName);
  return true;
}

}  // namespace detail
}  // namespace weir
