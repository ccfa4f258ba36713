// The parallel primitives on CUDA. Included by parallel.h where nvcc compiles.
#pragma once

#include <cuda_runtime.h>

#include <bit>
#include <limits>

#include "framework/base/api.h"
#include "framework/compute/kernel_overlap.h"
#include "framework/compute/launch_queue.h"
#include "framework/compute/wide_access.h"

namespace WEIR_API weir {
namespace detail {

inline constexpr int kCudaBlock = 256;  // threads
inline constexpr int kWarp = 32;        // threads

/// Blocks of a full reduction: enough to fill any device, and fixed, because results depend on it.
inline constexpr int kReduceBlocks = 1024;

/// Makes the device current for this thread, which may have used another since.
inline void beginLaunch(const CudaDevice& device, std::string_view name) {
  device.check(cudaSetDevice(device.index()), name);
}

/// Launches a kernel of kCudaBlock threads a block, now or with the batch that it is asked for in.
template <class... P>
static void launchOverlapping(CudaDevice& device, std::string_view name, Overlap overlap,
                              void (*kernel)(P...), unsigned blocks,
                              const std::type_identity_t<P>&... arguments) {
  beginLaunch(device, name);
  device.check(submitKernel(device.launches(), kernel, {blocks, kCudaBlock, 0, overlap}, arguments...), name);
}

/// The same for one that begins by waitForPriorKernel().
template <class... P>
static void launch(CudaDevice& device, std::string_view name, void (*kernel)(P...), unsigned blocks,
                   const std::type_identity_t<P>&... arguments) {
  launchOverlapping(device, name, {true}, kernel, blocks, arguments...);
}

/// What a functor says of itself, as kLeaves and kReadsAhead.
template <class F>
constexpr Overlap overlapOf() {
  Overlap overlap{true};
  if constexpr (requires { F::kLeaves; }) overlap.leaves = F::kLeaves;
  if constexpr (requires { F::kReadsAhead; }) overlap.readsAhead = F::kReadsAhead;
  return overlap;
}

/// How many there are, read ahead if F says so.
template <class F>
__device__ std::int64_t countAhead(const Count& count) {
  constexpr bool kAhead = overlapOf<F>().readsAhead != Standing::kNothing;
  if constexpr (!kAhead) waitForPriorKernel();
  return kAhead && count.exact != nullptr ? loadPastCache(*count.exact) : count.get();
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

/// How many blocks shall run on a multiprocessor side by side: what a functor says, as kBlocksTogether, that
/// waits for memory so much that more blocks are worth more than more registers. 0 leaves it to the compiler.
template <class F>
constexpr int blocksTogether() {
  if constexpr (requires { F::kBlocksTogether; })
    return F::kBlocksTogether;
  else
    return 0;
}

template <class F>
__global__ void __launch_bounds__(kCudaBlock, blocksTogether<F>())
    forEachKernel(Count count, const __grid_constant__ F f) {
  const std::int64_t n = countAhead<F>(count);
  waitForPriorKernel();
  const std::int64_t i = std::int64_t{blockIdx.x} * kCudaBlock + threadIdx.x;
  if (i < n) f(i);
  triggerDependentKernel();
}

template <class F>
__global__ void __launch_bounds__(kCudaBlock, blocksTogether<F>())
    forEachWithScratchKernel(Count count, const __grid_constant__ F f) {
  waitForPriorKernel();
  extern __shared__ int scratch[];
  const std::int64_t i = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < count.get()) f(i, Scratch{scratch + threadIdx.x, static_cast<int>(blockDim.x)});
  triggerDependentKernel();
}

/// Whether a functor wants all teams of a warp to call it together.
template <class F>
constexpr bool inStep() {
  if constexpr (requires { F::kInStep; })
    return F::kInStep;
  else
    return false;
}

template <int kSize, class F>
__global__ void __launch_bounds__(kCudaBlock) forEachInTeamsKernel(Count count, const __grid_constant__ F f) {
  constexpr bool kAwaits = overlapOf<F>().readsAhead == Standing::kLists;  // by itself
  const std::int64_t n = countAhead<F>(count);
  if constexpr (!kAwaits) waitForPriorKernel();
  const unsigned thread = threadIdx.x % kWarp, lane = thread % kSize;
  const std::int64_t ofWarp = (std::int64_t{blockIdx.x} * kCudaBlock + (threadIdx.x - thread)) / kSize;
  const std::int64_t i = ofWarp + thread / kSize;
  Team team{static_cast<int>(lane), kSize, static_cast<int>(thread - lane)};
  if constexpr (inStep<F>()) {
    team.spare = i >= n;
    if (ofWarp < n)
      f(team.spare ? n - 1 : i, team);
    else if constexpr (kAwaits)
      waitForPriorKernel();
  } else {
    static_assert(!kAwaits);
    if (i < n) f(i, team);
  }
  triggerDependentKernel();
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
///
/// `value` is the identity at first. The parameter itself takes the sum, here and below: where a variable
/// does that is a copy of it and larger than 128 bytes, nvcc 13.0 leaves out all turns of the loop but the
/// last ones.
template <class T, class F, class Op>
__global__ void __launch_bounds__(kCudaBlock)
    reduceKernel(Count count, T value, const __grid_constant__ F f, Op op, T* partial) {
  waitForPriorKernel();
  constexpr std::int64_t kStride = std::int64_t{kReduceBlocks} * kCudaBlock;
  const std::int64_t n = count.get();
  for (std::int64_t i = std::int64_t{blockIdx.x} * kCudaBlock + threadIdx.x; i < n; i += kStride) {
    value = op(value, static_cast<T>(f(i)));
  }
  value = reduceBlock(value, op);
  if (threadIdx.x == 0) partial[blockIdx.x] = value;
}

template <class T, class Op>
__global__ void __launch_bounds__(kCudaBlock)
    reducePartialsKernel(int blocks, T value, Op op, const T* partial, T* result) {
  waitForPriorKernel();
  for (int b = static_cast<int>(threadIdx.x); b < blocks; b += kCudaBlock) value = op(value, partial[b]);
  value = reduceBlock(value, op);
  if (threadIdx.x == 0) *result = value;
}

inline constexpr int kWarps = kCudaBlock / kWarp;  // of a block

/// kept[b] = how many elements block b keeps, and one more behind the last that is 0, so that a scan ends in
/// the total. votes[w] says which of 32 elements.
template <class Keep>
__global__ void __launch_bounds__(kCudaBlock)
    countKeptKernel(Count count, const __grid_constant__ Keep keep, int* kept, unsigned* votes) {
  waitForPriorKernel();
  const std::int64_t i = std::int64_t{blockIdx.x} * kCudaBlock + threadIdx.x;
  const bool keeps = i < count.get() && keep(i);
  const unsigned vote = __ballot_sync(~0u, keeps);
  if (threadIdx.x % kWarp == 0) votes[i / kWarp] = vote;
  const int here = __syncthreads_count(keeps);
  if (threadIdx.x != 0) return;
  kept[blockIdx.x] = here;
  if (blockIdx.x == 0) kept[gridDim.x] = 0;
}

/// The sum over the threads of the block, for all of them.
__device__ inline int sumInBlock(int value) {
  __shared__ int sums[kWarps];
  for (int step = kWarp / 2; step > 0; step /= 2) value += __shfl_xor_sync(~0u, value, step);
  if (threadIdx.x % kWarp == 0) sums[threadIdx.x / kWarp] = value;
  __syncthreads();
  int sum = 0;
  for (int w = 0; w < kWarps; ++w) sum += sums[w];
  return sum;
}

/// `kept` as above where there are few blocks, and *total is written; otherwise its prefix sums.
template <bool kFewBlocks>
__global__ void __launch_bounds__(kCudaBlock)
    writeKeptKernel(const int* kept, const unsigned* votes, int* indices, int* total) {
  waitForPriorKernel();
  const int i = static_cast<int>(blockIdx.x) * kCudaBlock + static_cast<int>(threadIdx.x);
  const int lane = static_cast<int>(threadIdx.x) % kWarp, warp = static_cast<int>(threadIdx.x) / kWarp;
  int place;
  if constexpr (kFewBlocks) {
    int before = 0;
    for (int b = static_cast<int>(threadIdx.x); b < static_cast<int>(blockIdx.x); b += kCudaBlock)
      before += kept[b];
    place = sumInBlock(before);
    if (blockIdx.x + 1 == gridDim.x && threadIdx.x == 0) *total = place + kept[blockIdx.x];
  } else {
    place = kept[blockIdx.x];
  }
  const unsigned* const ofBlock = votes + i / kWarp - warp;
  const unsigned vote = ofBlock[warp];
  if ((vote >> lane & 1) == 0) return;
  for (int w = 0; w < warp; ++w) place += __popc(ofBlock[w]);
  indices[place + __popc(vote & ((1u << lane) - 1))] = i;
}

}  // namespace detail

template <class F>
void parallelFor(CudaDevice& device, std::string_view name, Count count, const F& f) {
  if (count.bound <= 0) return;
  const KernelScope scope(device.profiler(), name);
  const Count steady = detail::steadyCount(count);
  detail::launchOverlapping(device, name, detail::overlapOf<F>(), detail::forEachKernel<F>,
                            detail::blocksFor(steady.bound), steady, f);
}

template <class F>
void parallelForWithScratch(CudaDevice& device, std::string_view name, Count count, int numbers, const F& f) {
  constexpr unsigned kSharedBytes = 48 << 10;  // what any kernel may use
  WEIR_CHECK(numbers <= kMaxScratch);
  if (count.bound <= 0) return;
  const KernelScope scope(device.profiler(), name);
  const unsigned bytes = static_cast<unsigned>(numbers) * sizeof(int);
  unsigned threads = detail::kCudaBlock;
  while (threads * bytes > kSharedBytes) threads /= 2;
  const Count steady = detail::steadyCount(count);
  detail::beginLaunch(device, name);
  device.check(detail::submitKernel(device.launches(), detail::forEachWithScratchKernel<F>,
                                    {detail::blocksFor(steady.bound, threads), threads, threads * bytes,
                                     detail::overlapOf<F>()},
                                    steady, f),
               name);
}

template <TeamPlan kPlan, class F>
void parallelForTeams(CudaDevice& device, std::string_view name, Count count, const F& f) {
  static_assert(Team::kMax == detail::kWarp && detail::kWarp % kPlan.size == 0);
  if (count.bound <= 0) return;
  if (count.bound > kPlan.few) return parallelFor(device, name, count, detail::CallAlone<F>{f});
  const KernelScope scope(device.profiler(), name);
  const Count steady = detail::steadyCount(count);
  detail::launchOverlapping(device, name, detail::overlapOf<F>(), detail::forEachInTeamsKernel<kPlan.size, F>,
                            detail::blocksFor(kPlan.size * steady.bound), steady, f);
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
  // How many other blocks' partial sums each block can add.
  constexpr unsigned kFewBlocks = 1024;
  Array<int> keptBy(device, std::int64_t{blocks} + 1);
  Array<unsigned> votes(device, std::int64_t{blocks} * detail::kWarps);
  detail::launch(device, name, detail::countKeptKernel<Keep>, blocks, steady, keep, keptBy.data(),
                 votes.data());
  if (blocks <= kFewBlocks) {
    detail::launch(device, name, detail::writeKeptKernel<true>, blocks, keptBy.data(), votes.data(),
                   indices.data, kept);
    return;
  }
  exclusiveScan(device, keptBy.view(), keptBy.view(), keptBy.size());
  detail::launch(device, name, detail::writeKeptKernel<false>, blocks, keptBy.data(), votes.data(),
                 indices.data, kept);
  device.copy(kept, keptBy.data() + blocks, sizeof(int));
}

}  // namespace weir
