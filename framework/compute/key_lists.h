// Which of many things belong to each key, such as the particles at each body; and reduceByKey() that asks
// no others. reduceByKey() itself costs things × keys.
#pragma once

#include <algorithm>
#include <utility>

#include "framework/base/api.h"
#include "framework/compute/array.h"
#include "framework/compute/reduce_by_key.h"

namespace WEIR_API weir {

/// The things of key k are item[first[k]] … item[first[k + 1] − 1], in ascending order; empty where nobody
/// has listed them.
struct KeyListsView {
  ArrayView<const int> first, item;
};

class KeyLists {
 public:
  explicit KeyLists(Device& device) : keys_(device), items_(device), first_(device) {}

  /// Room for so many entries, none of which is anybody's yet.
  void clear(std::int64_t entries);
  /// The same for an entry of each thing that is counted.
  void clear(Device& device, const Count& things) {
    clear(device.kind() == DeviceKind::kCpu ? things.get() : things.bound);
  }
  /// For a kernel that writes key and item of entries, in which the items of a key ascend.
  ArrayView<std::uint32_t> keys() { return keys_.view(); }
  ArrayView<int> items() { return items_.view(); }
  /// Then lists them by keys below this number.
  template <class Backend>
  void sort(Backend& device, std::int64_t keys);

  KeyListsView view() const { return {first_.view(), items_.view()}; }
  void forget() { first_.resizeDiscarding(0); }
  /// With up to so many keys, of which few need no lists.
  static bool areFew(std::int64_t keys) { return keys < 16; }
  static double memoryFor(double entries, std::int64_t keys);

 private:
  Array<std::uint32_t> keys_;
  Array<int> items_, first_;
};

namespace detail {

/// Where the entries of key k begin.
struct FindFirst {
  ArrayView<const std::uint32_t> keys;
  ArrayView<int> first;

  WEIR_HD void operator()(std::int64_t k) const {
    std::int64_t low = 0, high = keys.size;
    while (low < high) {
      const std::int64_t middle = (low + high) / 2;
      if (static_cast<std::int64_t>(keys[middle]) < k)
        low = middle + 1;
      else
        high = middle;
    }
    first[k] = static_cast<int>(low);
  }
};

}  // namespace detail

template <class Backend>
void KeyLists::sort(Backend& device, std::int64_t keys) {
  if (keys_.size() > 1) stableSortByKey(device, keys_.view(), items_.view(), keys_.size());
  first_.resizeDiscarding(keys + 1);
  parallelFor(device, "first of keys", keys + 1,
              detail::FindFirst{std::as_const(keys_).view(), first_.view()});
}

/// reduceByKey() with f as there, where f(i, …) gives something to key k only if i is in the list of k. Sums
/// of a key have an order of their own: results depend on the values in its list alone.
template <class T, class F, class Op>
void reduceListed(CpuBackend& device, std::string_view name, const KeyListsView& lists, T identity,
                  const F& f, const Op& op, T* results);
template <class T, class F, class Op>
void reduceListed(CudaDevice& device, std::string_view name, const KeyListsView& lists, T identity,
                  const F& f, const Op& op, T* results);

template <class T, class F, class Op>
void reduceListed(CpuBackend& device, std::string_view name, const KeyListsView& lists, T identity,
                  const F& f, const Op& op, T* results) {
  const KernelScope scope(device.profiler(), name);
  detail::forRanges(device, lists.first.size - 1, 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k) {
      T sum = identity;
      const detail::TakeOfKey<T, Op> take{static_cast<int>(k), op, &sum};
      for (int n = lists.first[k]; n < lists.first[k + 1]; ++n) f(lists.item[n], take);
      results[k] = sum;
    }
  });
}

#ifdef __CUDACC__

namespace detail {

/// By `blocks` blocks for each key. (`value` is the identity at first, see reduceKernel().)
template <class T, class F, class Op>
__global__ void __launch_bounds__(kCudaBlock)
    reduceListedKernel(KeyListsView lists, int blocks, T value, const __grid_constant__ F f, Op op,
                       T* partial) {
  waitForPriorKernel();
  const int k = static_cast<int>(blockIdx.x) / blocks, block = static_cast<int>(blockIdx.x) % blocks;
  const TakeOfKey<T, Op> take{k, op, &value};
  const std::int64_t stride = std::int64_t{blocks} * kCudaBlock, end = lists.first[k + 1];
  for (std::int64_t n = lists.first[k] + std::int64_t{block} * kCudaBlock + threadIdx.x; n < end; n += stride)
    f(lists.item[n], take);
  value = reduceBlock(value, op);
  if (threadIdx.x == 0) partial[blockIdx.x] = value;
}

}  // namespace detail

template <class T, class F, class Op>
void reduceListed(CudaDevice& device, std::string_view name, const KeyListsView& lists, T identity,
                  const F& f, const Op& op, T* results) {
  const std::int64_t keys = lists.first.size - 1;
  if (keys <= 0) return;
  const KernelScope scope(device.profiler(), name);
  // Of a few keys, one may have nearly all things.
  const int blocks = static_cast<int>(std::max<std::int64_t>(1, detail::kReduceBlocks / keys));
  Array<T> partials(device, blocks > 1 ? blocks * keys : 0);
  detail::launch(device, name, detail::reduceListedKernel<T, F, Op>, detail::blocksFor(blocks * keys, 1),
                 lists, blocks, identity, f, op, blocks > 1 ? partials.data() : results);
  if (blocks > 1)
    detail::launch(device, name, detail::reducePartialsByKeyKernel<T, Op>, detail::blocksFor(keys, 1), blocks,
                   identity, op, partials.data(), results);
}

#endif

}  // namespace weir
