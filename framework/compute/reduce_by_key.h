// reduce() for several results at once, such as the forces on many bodies: one pass, whatever their number.
#pragma once

#include <vector>

#include "framework/compute/parallel.h"

namespace weir {

/// f(i, give) calls give(key, make) for each value make() that belongs to a key in [0, keys). Writes to
/// results[key] (device memory) what reduce() would of the values of that key, to the same bits, where f
/// gives at most one value to it for each i in [0, count).
template <class T, class F, class Op>
void reduceByKey(CpuBackend& device, std::string_view name, Count count, std::int64_t keys, T identity,
                 const F& f, const Op& op, T* results);
template <class T, class F, class Op>
void reduceByKey(CudaDevice& device, std::string_view name, Count count, std::int64_t keys, T identity,
                 const F& f, const Op& op, T* results);

namespace detail {

/// Takes the values of one key.
template <class T, class Op>
struct TakeOfKey {
  int key;
  Op op;
  T* sum;

  template <class Make>
  WEIR_HD void operator()(int of, const Make& make) const {
    if (of == key) *sum = op(*sum, make());
  }
};

/// reduceRange() for every key.
template <class T, class F, class Op>
void reduceRangeByKey(std::int64_t begin, std::int64_t end, std::int64_t keys, const T& identity, const F& f,
                      const Op& op, T* results) {
  constexpr int kLanes = 8;
  std::vector<T> lanes(static_cast<std::size_t>(kLanes * keys), identity);
  for (std::int64_t i = begin; i < end; ++i) {
    T* const lane = lanes.data() + (i - begin) % kLanes * keys;
    f(i, [&](int key, const auto& make) { lane[key] = op(lane[key], make()); });
  }
  for (std::int64_t width = kLanes / 2 * keys; width >= keys; width /= 2)
    for (std::int64_t l = 0; l < width; ++l)
      lanes[std::size_t(l)] = op(lanes[std::size_t(l)], lanes[std::size_t(l + width)]);
  std::copy_n(lanes.data(), keys, results);
}

}  // namespace detail

template <class T, class F, class Op>
void reduceByKey(CpuBackend& device, std::string_view name, Count count, std::int64_t keys, T identity,
                 const F& f, const Op& op, T* results) {
  if (keys <= 0) return;
  const KernelScope scope(device.profiler(), name);
  const std::int64_t n = count.get();
  if (n <= detail::kCpuBlock) {
    detail::reduceRangeByKey(0, n, keys, identity, f, op, results);
    return;
  }
  const std::int64_t blocks = (n - 1) / detail::kCpuBlock + 1;
  Array<T> partials(device, blocks * keys);
  T* partial = partials.data();
  detail::forRanges(device, n, detail::kCpuBlock, [&](std::int64_t begin, std::int64_t end) {
    detail::reduceRangeByKey(begin, end, keys, identity, f, op, partial + begin / detail::kCpuBlock * keys);
  });
  for (std::int64_t stride = 1; stride < blocks; stride *= 2)
    for (std::int64_t b = 0; b + stride < blocks; b += 2 * stride)
      for (std::int64_t k = b * keys; k < (b + 1) * keys; ++k)
        partial[k] = op(partial[k], partial[k + stride * keys]);
  std::copy_n(partial, keys, results);
}

#ifdef __CUDACC__

namespace detail {

/// reduceKernel() for every key, by `blocks` blocks each.
template <class T, class F, class Op>
__global__ void __launch_bounds__(kCudaBlock)
    reduceByKeyKernel(Count count, int blocks, T value, const __grid_constant__ F f, Op op, T* partial) {
  waitForPriorKernel();
  constexpr std::int64_t kStride = std::int64_t{kReduceBlocks} * kCudaBlock;
  const std::int64_t n = count.get();
  const int block = static_cast<int>(blockIdx.x) % blocks;
  const TakeOfKey<T, Op> take{static_cast<int>(blockIdx.x) / blocks, op, &value};
  for (std::int64_t i = std::int64_t{block} * kCudaBlock + threadIdx.x; i < n; i += kStride) f(i, take);
  value = reduceBlock(value, op);
  if (threadIdx.x == 0) partial[blockIdx.x] = value;
}

/// reducePartialsKernel() for every key.
template <class T, class Op>
__global__ void __launch_bounds__(kCudaBlock)
    reducePartialsByKeyKernel(int blocks, T value, Op op, const T* partial, T* results) {
  waitForPriorKernel();
  const T* const ofKey = partial + std::int64_t{blockIdx.x} * blocks;
  for (int b = static_cast<int>(threadIdx.x); b < blocks; b += kCudaBlock) value = op(value, ofKey[b]);
  value = reduceBlock(value, op);
  if (threadIdx.x == 0) results[blockIdx.x] = value;
}

}  // namespace detail

template <class T, class F, class Op>
void reduceByKey(CudaDevice& device, std::string_view name, Count count, std::int64_t keys, T identity,
                 const F& f, const Op& op, T* results) {
  if (keys <= 0) return;
  const KernelScope scope(device.profiler(), name);
  const Count steady = detail::steadyCount(count);
  const std::int64_t full =
      std::min<std::int64_t>(steady.bound, std::int64_t{detail::kReduceBlocks} * detail::kCudaBlock);
  const int blocks = std::max(1, static_cast<int>(detail::blocksFor(full)));
  const unsigned all = detail::blocksFor(blocks * keys, 1);
  if (blocks == 1) {
    detail::launch(device, name, detail::reduceByKeyKernel<T, F, Op>, all, steady, blocks, identity, f, op,
                   results);
    return;
  }
  Array<T> partials(device, blocks * keys);
  detail::launch(device, name, detail::reduceByKeyKernel<T, F, Op>, all, steady, blocks, identity, f, op,
                 partials.data());
  detail::launch(device, name, detail::reducePartialsByKeyKernel<T, Op>, detail::blocksFor(keys, 1), blocks,
                 identity, op, partials.data(), results);
}

#endif

}  // namespace weir
