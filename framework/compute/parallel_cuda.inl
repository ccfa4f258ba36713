// The parallel primitives on CUDA. Included by parallel.h where nvcc compiles.
#pragma once

#include <cuda_runtime.h>

#include <bit>
#include <limits>

#include "framework/compute/launch_queue.h"

namespace weir {
namespace detail {

inline constexpr int kCudaBlock = 256;  // threads
inline constexpr int kWarp = 32;        // threads

/// Blocks of a full reduction: enough to fill any device, and fixed, because results depend on it.
inline constexpr int kReduceBlocks = 1024;

/// Makes the device current for the launches of this library: the CUDA runtime is linked into each shared
/// library, and each copy has its own current device and its own last error.
inline void beginLaunch(const CudaDevice& device, std::string_view name) {
  device.check(cudaSetDevice(device.index()), name);
}

/// Launches a kernel of kCudaBlock threads a block, now or with the batch that it is asked for in.
template <class... P>
void launch(CudaDevice& device, std::string_view name, void (*kernel)(P...), unsigned blocks,
            const std::type_identity_t<P>&... arguments) {
  beginLaunch(device, name);
  device.check(submitKernel(device.launches(), kernel, blocks, kCudaBlock, 0, arguments...), name);
}

/// Where the device knows how many there are, the bound decides on the size of a grid alone. It grows in
/// steps, so that a fluid that grows asks for the same grid most of the time.
inline Count steadyCount(Count count) {
  if (count.exact == nullptr) return count;
  const std::int64_t step =
      std::max<std::int64_t>(std::bit_ceil(static_cast<std::uint64_t>(count.bound)) / 16, kCudaBlock);
  return {(count.bound + step - 1) / step * step, count.exact};
}

/// Blocks that give each of n elements a thread.
inline unsigned blocksFor(std::int64_t n, std::int64_t threads = kCudaBlock) {
  const std::int64_t blocks = (n + threads - 1) / threads;
  WEIR_CHECK(blocks <= std::numeric_limits<int>::max());
  return static_cast<unsigned>(blocks);
}

template <class F>
__global__ void __launch_bounds__(kCudaBlock) forEachKernel(Count count, const __grid_constant__ F f) {
  const std::int64_t i = std::int64_t{blockIdx.x} * kCudaBlock + threadIdx.x;
  if (i < count.get()) f(i);
}

template <class F>
__global__ void __launch_bounds__(kCudaBlock)
    forEachWithScratchKernel(Count count, const __grid_constant__ F f) {
  extern __shared__ int scratch[];
  const std::int64_t i = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < count.get()) f(i, Scratch{scratch + threadIdx.x, static_cast<int>(blockDim.x)});
}

template <class F>
__global__ void __launch_bounds__(kCudaBlock)
    forEachInTeamsKernel(Count count, int size, const __grid_constant__ F f) {
  const std::int64_t thread = std::int64_t{blockIdx.x} * kCudaBlock + threadIdx.x;
  const std::int64_t i = thread / size;
  const int lane = static_cast<int>(threadIdx.x) % size;
  if (i < count.get()) f(i, Team{lane, size, static_cast<int>(threadIdx.x) % kWarp - lane});
}

/// A team of one.
template <class F>
struct CallAlone {
  F f;
  __device__ void operator()(std::int64_t i) const {
    f(i, Team{0, 1, static_cast<int>(threadIdx.x) % kWarp});
  }
};

/// op over one value of every thread of the block, for thread 0. The order is a fixed tree.
/// Once in a kernel, because nothing guards its shared memory afterwards.
template <class T, class Op>
__device__ T reduceBlock(const T& value, const Op& op) {
  // Bytes, because shared memory cannot hold a type with default member values.
  __shared__ alignas(T) unsigned char storage[kCudaBlock * sizeof(T)];
  T* const values = reinterpret_cast<T*>(storage);
  const int thread = static_cast<int>(threadIdx.x);
  values[thread] = value;
  for (int width = kCudaBlock / 2; width > 0; width /= 2) {
    __syncthreads();
    if (thread < width) values[thread] = op(values[thread], values[thread + width]);
  }
  return values[thread];
}

/// Thread t takes the elements t, t + S, t + 2S, … where S is the number of threads of a full grid. A grid
/// that is smaller has a thread for every element anyway, so its size does not change the result.
template <class T, class F, class Op>
__global__ void __launch_bounds__(kCudaBlock)
    reduceKernel(Count count, T identity, const __grid_constant__ F f, Op op, T* partial) {
  constexpr std::int64_t kStride = std::int64_t{kReduceBlocks} * kCudaBlock;
  const std::int64_t n = count.get();
  T value = identity;
  for (std::int64_t i = std::int64_t{blockIdx.x} * kCudaBlock + threadIdx.x; i < n; i += kStride) {
    value = op(value, static_cast<T>(f(i)));
  }
  value = reduceBlock(value, op);
  if (threadIdx.x == 0) partial[blockIdx.x] = value;
}

template <class T, class Op>
__global__ void __launch_bounds__(kCudaBlock)
    reducePartialsKernel(int blocks, T identity, Op op, const T* partial, T* result) {
  T value = identity;
  for (int b = static_cast<int>(threadIdx.x); b < blocks; b += kCudaBlock) value = op(value, partial[b]);
  value = reduceBlock(value, op);
  if (threadIdx.x == 0) *result = value;
}

/// first[b] = how many elements block b keeps; the entry behind the last is 0, so that a scan ends in the
/// total.
template <class Keep>
__global__ void __launch_bounds__(kCudaBlock)
    countKeptKernel(Count count, const __grid_constant__ Keep keep, int* first) {
  const std::int64_t i = std::int64_t{blockIdx.x} * kCudaBlock + threadIdx.x;
  const int kept = __syncthreads_count(i < count.get() && keep(i));
  if (threadIdx.x != 0) return;
  first[blockIdx.x] = kept;
  if (blockIdx.x == 0) first[gridDim.x] = 0;
}

template <class Keep>
__global__ void __launch_bounds__(kCudaBlock)
    writeKeptKernel(Count count, const __grid_constant__ Keep keep, const int* first, int* indices) {
  __shared__ int keptByWarp[kCudaBlock / kWarp];
  const std::int64_t i = std::int64_t{blockIdx.x} * kCudaBlock + threadIdx.x;
  const bool kept = i < count.get() && keep(i);
  const unsigned votes = __ballot_sync(~0u, kept);
  const int lane = static_cast<int>(threadIdx.x) % kWarp, warp = static_cast<int>(threadIdx.x) / kWarp;
  if (lane == 0) keptByWarp[warp] = __popc(votes);
  __syncthreads();
  if (!kept) return;
  int place = first[blockIdx.x] + __popc(votes & ((1u << lane) - 1));
  for (int w = 0; w < warp; ++w) place += keptByWarp[w];
  indices[place] = static_cast<int>(i);
}

}  // namespace detail

template <class F>
void parallelFor(CudaDevice& device, std::string_view name, Count count, const F& f) {
  if (count.bound <= 0) return;
  const KernelScope scope(device.profiler(), name);
  const Count steady = detail::steadyCount(count);
  detail::launch(device, name, detail::forEachKernel<F>, detail::blocksFor(steady.bound), steady, f);
}

template <class F>
void parallelForWithScratch(CudaDevice& device, std::string_view name, Count count, int numbers, const F& f) {
  constexpr unsigned kSharedBytes = 48 << 10;  // what any kernel may use
  WEIR_CHECK(numbers <= kMostScratch);
  if (count.bound <= 0) return;
  const KernelScope scope(device.profiler(), name);
  const unsigned bytes = static_cast<unsigned>(numbers) * sizeof(int);
  unsigned threads = detail::kCudaBlock;
  while (threads * bytes > kSharedBytes) threads /= 2;
  const Count steady = detail::steadyCount(count);
  detail::beginLaunch(device, name);
  device.check(
      detail::submitKernel(device.launches(), detail::forEachWithScratchKernel<F>,
                           detail::blocksFor(steady.bound, threads), threads, threads * bytes, steady, f),
      name);
}

template <class F>
void parallelForTeams(CudaDevice& device, std::string_view name, Count count, TeamPlan plan, const F& f) {
  static_assert(Team::kMost == detail::kWarp);
  if (count.bound <= 0) return;
  if (count.bound > plan.few) return parallelFor(device, name, count, detail::CallAlone<F>{f});
  const KernelScope scope(device.profiler(), name);
  const Count steady = detail::steadyCount(count);
  detail::launch(device, name, detail::forEachInTeamsKernel<F>, detail::blocksFor(plan.size * steady.bound),
                 steady, plan.size, f);
}

template <class T, class F, class Op>
void reduce(CudaDevice& device, std::string_view name, Count count, T identity, const F& f, const Op& op,
            T* result) {
  const KernelScope scope(device.profiler(), name);
  const Count steady = detail::steadyCount(count);
  const std::int64_t full =
      std::min<std::int64_t>(steady.bound, std::int64_t{detail::kReduceBlocks} * detail::kCudaBlock);
  const int blocks = std::max(1, static_cast<int>(detail::blocksFor(full)));
  if (blocks == 1) {
    detail::launch(device, name, detail::reduceKernel<T, F, Op>, 1, steady, identity, f, op, result);
    return;
  }
  Array<T> partials(device, blocks);
  detail::launch(device, name, detail::reduceKernel<T, F, Op>, static_cast<unsigned>(blocks), steady,
                 identity, f, op, partials.data());
  detail::launch(device, name, detail::reducePartialsKernel<T, Op>, 1, blocks, identity, op, partials.data(),
                 result);
}

template <class Keep>
void compact(CudaDevice& device, std::string_view name, Count count, const Keep& keep, ArrayView<int> indices,
             int* kept) {
  const KernelScope scope(device.profiler(), name);
  WEIR_CHECK(indices.size >= count.bound);
  if (count.bound <= 0) {
    device.fillBytes(kept, 0, sizeof(int));
    return;
  }
  const Count steady = detail::steadyCount(count);
  const unsigned blocks = detail::blocksFor(steady.bound);
  Array<int> firsts(device, std::int64_t{blocks} + 1);
  detail::launch(device, name, detail::countKeptKernel<Keep>, blocks, steady, keep, firsts.data());
  exclusiveScan(device, firsts.view(), firsts.view(), firsts.size());
  detail::launch(device, name, detail::writeKeptKernel<Keep>, blocks, steady, keep, firsts.data(),
                 indices.data);
  // Last, because `kept` may be where the count stands that the kernels read.
  device.copy(kept, firsts.data() + blocks, sizeof(int));
}

}  // namespace weir
