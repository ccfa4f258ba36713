// Scan and sort on the CPU. Both work in blocks; integers and a stable order make the results unique, so the
// blocks may be chosen freely.
#include <array>
#include <numeric>

#include "framework/base/check.h"
#include "framework/compute/parallel.h"

namespace weir {
namespace {

constexpr int kDigitBits = 8;
constexpr int kDigits = 1 << kDigitBits;

/// Blocks large enough that their histograms cost little.
std::int64_t sortGrain(std::int64_t n, int threads) {
  return std::max<std::int64_t>(8192, n / (std::int64_t{threads} * 4) + 1);
}

/// Places of one digit's values: counts by block, and then where each block's next key of that digit goes.
class DigitPlaces {
 public:
  DigitPlaces(CpuBackend& device, std::int64_t n)
      : grain_(sortGrain(n, device.threads())),
        blocks_((n - 1) / grain_ + 1),
        place_(device, blocks_ * kDigits) {}

  std::int64_t grain() const { return grain_; }
  int* ofBlock(std::int64_t begin) { return place_.data() + begin / grain_ * kDigits; }

  /// Turns counts into first places; false if all keys have the same digit, so that nothing would move.
  bool scan(std::int64_t n) {
    int total = 0;
    for (int digit = 0; digit < kDigits; ++digit) {
      const int before = total;
      for (std::int64_t block = 0; block < blocks_; ++block) {
        int& place = place_.data()[block * kDigits + digit];
        total += std::exchange(place, total);
      }
      if (total - before == n) return false;
    }
    return true;
  }

 private:
  std::int64_t grain_, blocks_;
  Array<int> place_;
};

/// Least significant digit first; every pass is stable.
template <class Key>
void radixSort(CpuBackend& device, ArrayView<Key> keys, ArrayView<int> values, std::int64_t n) {
  WEIR_CHECK(keys.size >= n);
  WEIR_CHECK(values.size >= n);
  if (n <= 1) return;
  Array<Key> otherKeys(device, n);
  Array<int> otherValues(device, n);
  Key *key = keys.data, *nextKey = otherKeys.data();
  int *value = values.data, *nextValue = otherValues.data();
  DigitPlaces places(device, n);
  for (int shift = 0; shift < static_cast<int>(sizeof(Key)) * 8; shift += kDigitBits) {
    const auto digit = [shift](Key k) { return static_cast<int>((k >> shift) & Key{kDigits - 1}); };
    detail::forRanges(device, n, places.grain(), [&](std::int64_t begin, std::int64_t end) {
      int* count = places.ofBlock(begin);
      std::fill_n(count, kDigits, 0);
      for (std::int64_t i = begin; i < end; ++i) ++count[digit(key[i])];
    });
    if (!places.scan(n)) continue;
    detail::forRanges(device, n, places.grain(), [&](std::int64_t begin, std::int64_t end) {
      int* place = places.ofBlock(begin);
      for (std::int64_t i = begin; i < end; ++i) {
        const int to = place[digit(key[i])]++;
        nextKey[to] = key[i];
        nextValue[to] = value[i];
      }
    });
    std::swap(key, nextKey);
    std::swap(value, nextValue);
  }
  if (key == keys.data) return;
  device.copy(keys.data, key, static_cast<std::size_t>(n) * sizeof(Key));
  device.copy(values.data, value, static_cast<std::size_t>(n) * sizeof(int));
}

}  // namespace

void exclusiveScan(CpuBackend& device, ArrayView<const int> in, ArrayView<int> out, std::int64_t n) {
  const KernelScope scope(device.profiler(), "exclusiveScan");
  WEIR_CHECK(in.size >= n);
  WEIR_CHECK(out.size >= n);
  constexpr std::int64_t kGrain = 16384;
  if (n <= kGrain) {
    std::exclusive_scan(in.data, in.data + n, out.data, 0);
    return;
  }
  const std::int64_t blocks = (n - 1) / kGrain + 1;
  Array<int> firsts(device, blocks);
  int* first = firsts.data();
  detail::forRanges(device, n, kGrain, [&](std::int64_t begin, std::int64_t end) {
    first[begin / kGrain] = std::reduce(in.data + begin, in.data + end, 0);
  });
  std::exclusive_scan(first, first + blocks, first, 0);
  detail::forRanges(device, n, kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::exclusive_scan(in.data + begin, in.data + end, out.data + begin, first[begin / kGrain]);
  });
}

void stableSortByKey(CpuBackend& device, ArrayView<std::uint32_t> keys, ArrayView<int> values,
                     std::int64_t n) {
  const KernelScope scope(device.profiler(), "stableSortByKey");
  radixSort(device, keys, values, n);
}

void stableSortByKey(CpuBackend& device, ArrayView<std::uint64_t> keys, ArrayView<int> values,
                     std::int64_t n) {
  const KernelScope scope(device.profiler(), "stableSortByKey");
  radixSort(device, keys, values, n);
}

}  // namespace weir
