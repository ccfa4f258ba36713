#include "framework/compute/parallel.h"
#include "framework/compute/dispatch.h"

#include <cstring>
#include <random>
#include <stdexcept>

#include "tests/framework/compute/kernels.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

using ParallelTest = OnDevice;
WEIR_ON_EVERY_DEVICE(ParallelTest);

const std::vector<int> kSizes{0,    1,    2,    31,   32,   33,    255,   256,   257,    1023,    1024,
                              1025, 4095, 4096, 4097, 8191, 16384, 16385, 65537, 262145, 1000007, 1048577};

std::vector<int> randomInts(int n, int min, int max, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> pick(min, max);
  std::vector<int> values(static_cast<std::size_t>(n));
  for (int& v : values) v = pick(random);
  return values;
}

std::vector<float> randomFloats(int n) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> pick(-1.0f, 1.0f);
  std::vector<float> values(static_cast<std::size_t>(n));
  for (float& v : values) v = pick(random) * std::exp(4 * pick(random));
  return values;
}

/// A number in device memory.
template <class T>
class DeviceValue {
 public:
  DeviceValue(Device& device, T value) : array_(device, std::span<const T>(&value, 1)) {}
  T* get() { return array_.data(); }
  T read() const { return array_.toHost()[0]; }

 private:
  Array<T> array_;
};

/// A count whose host bound is larger than the exact number on the device.
class LooseCount {
 public:
  LooseCount(Device& device, int exact, int bound) : exact_(device, exact), bound_(bound) {}
  operator Count() { return {bound_, exact_.get()}; }

 private:
  DeviceValue<int> exact_;
  int bound_;
};

float sumOf(Device& device, Count count, const Array<float>& values) {
  DeviceValue<float> result(device, -1);
  dispatch(device, [&](auto& d) { sum(d, count, values.view(), result.get()); });
  return result.read();
}

TEST_P(ParallelTest, TeamsShareTheirCalls) {
  for (const int size : {1, 2, 8, 32}) {
    for (const int n : {0, 1, 31, 1000, 1001}) {
      Array<float> out(*device, n);
      Array<int> lanes(*device, n);
      dispatch(*device, [&](auto& backend) { sumInTeams(backend, n, size, out.view(), lanes.view()); });
      const bool teams = device->kind() == DeviceKind::kCuda && n <= kFewTeams;
      const int expected = !teams ? 1 : size == 32 ? -1 : (1 << size) - 1;
      const std::vector<float> sums = out.toHost();
      for (int i = 0; i < n; ++i) ASSERT_EQ(sums[std::size_t(i)], float(100 * i + 4950)) << size;
      EXPECT_EQ(lanes.toHost(), std::vector<int>(std::size_t(n), expected)) << size;
    }
  }
}

TEST_P(ParallelTest, ParallelForReachesEveryElementOnce) {
  for (const int n : kSizes) {
    Array<std::int64_t> out(*device, n + 3);
    out.fillZero();
    dispatch(*device, [&](auto& d) { writeSquares(d, n, out.view()); });
    const std::vector<std::int64_t> values = out.toHost();
    for (std::int64_t i = 0; i < n + 3; ++i) {
      ASSERT_EQ(values[static_cast<std::size_t>(i)], i < n ? i * i + 1 : 0) << "n = " << n << ", i = " << i;
    }
  }
}

TEST_P(ParallelTest, ParallelForStopsAtTheExactCount) {
  for (const int exact : {0, 1, 300, 5000}) {
    Array<std::int64_t> out(*device, 5000);
    out.fillZero();
    LooseCount count(*device, exact, 5000);
    dispatch(*device, [&](auto& d) { writeSquares(d, count, out.view()); });
    const std::vector<std::int64_t> values = out.toHost();
    for (std::int64_t i = 0; i < 5000; ++i) {
      ASSERT_EQ(values[static_cast<std::size_t>(i)], i < exact ? i * i + 1 : 0) << "exact = " << exact;
    }
  }
}

TEST_P(ParallelTest, AtomicAddLosesNothing) {
  const std::vector<int> values = randomInts(200003, 0, 100);
  std::vector<int> expected(17, 0);
  for (const int v : values) expected[static_cast<std::size_t>(v % 17)] += v;
  Array<int> in(*device, values), counters(*device, 17);
  counters.fillZero();
  dispatch(*device,
           [&](auto& d) { addToCounters(d, static_cast<int>(values.size()), in.view(), counters.view()); });
  EXPECT_EQ(counters.toHost(), expected);
}

TEST_P(ParallelTest, ReduceSumsIntegersExactly) {
  for (const int n : kSizes) {
    const std::vector<int> values = randomInts(n, -1000000, 1000000);
    std::int64_t expected = 0;
    for (const int v : values) expected += v;
    Array<int> in(*device, values);
    DeviceValue<std::int64_t> result(*device, -1);
    dispatch(*device, [&](auto& d) { sum(d, n, in.view(), result.get()); });
    EXPECT_EQ(result.read(), expected) << "n = " << n;
  }
}

TEST_P(ParallelTest, ReduceSumsFloatsWithinRounding) {
  for (const int n : kSizes) {
    const std::vector<float> values = randomFloats(n);
    double expected = 0, magnitude = 0;
    for (const float v : values) expected += v, magnitude += std::abs(v);
    Array<float> in(*device, values);
    // A tree of depth 20 with runs of at most 512 additions below it.
    EXPECT_NEAR(sumOf(*device, n, in), expected, magnitude * 532 * 6e-8) << "n = " << n;
  }
}

TEST_P(ParallelTest, ReduceDependsOnTheExactCountAlone) {
  for (const int exact : {0, 1, 255, 256, 257, 4096, 4097, 100003, 300007}) {
    const std::vector<float> values = randomFloats(1200000);
    Array<float> in(*device, values);
    const float tight = sumOf(*device, exact, in);
    for (const int bound : {exact, exact + 1, 300007, 1200000}) {
      LooseCount count(*device, exact, bound);
      EXPECT_EQ(sumOf(*device, count, in), tight) << "exact = " << exact << ", bound = " << bound;
    }
  }
}

TEST_P(ParallelTest, ReduceTakesStructures) {
  const std::vector<float> numbers = randomFloats(3 * 50001);
  std::vector<Vec3f> points(50001);
  Aabb expected;
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
    expected.extend(points[i]);
  }
  Array<Vec3f> in(*device, points);
  DeviceValue<Aabb> result(*device, Aabb{});
  dispatch(*device, [&](auto& d) { boundingBox(d, 50001, in.view(), result.get()); });
  EXPECT_EQ(result.read().lo, expected.lo);
  EXPECT_EQ(result.read().hi, expected.hi);
}

TEST_P(ParallelTest, ReduceByKeyHasTheBitsOfOneReduceForEachKey) {
  for (const int keys : {1, 3, 100}) {
    for (const int n : {0, 1, 300, 4096, 4097, 100003, 300007}) {
      const std::vector<float> values = randomFloats(n + 1000);
      Array<float> in(*device, values), sums(*device, keys), expected(*device, keys);
      Array<int> keyOf(*device, randomInts(n + 1000, -1, keys - 1));
      LooseCount count(*device, n, n + 1000);
      dispatch(*device, [&](auto& d) {
        sumByKey(d, count, in.view(), keyOf.view(), sums.view());
        for (int k = 0; k < keys; ++k) sumOfKey(d, count, in.view(), keyOf.view(), k, expected.data() + k);
      });
      EXPECT_EQ(sums.toHost(), expected.toHost()) << keys << " keys of " << n;
    }
  }
}

bool same(const SixSums& a, const SixSums& b) {
  return std::memcmp(&a, &b, sizeof(SixSums)) == 0;  // which has no padding
}

TEST_P(ParallelTest, ResultsOfManyBytesAreReducedWhole) {
  for (const int n : {1000, 70001, 600011}) {
    const std::vector<float> values = randomFloats(n);
    const std::vector<int> keys = randomInts(n, -1, 1);
    SixSums expected;
    std::vector<SixSums> expectedByKey(2);
    for (int i = 0; i < n; ++i) {
      expected += sixTimes(values[i]);
      if (keys[i] >= 0) expectedByKey[keys[i]] += sixTimes(values[i]);
    }
    const Array<float> in(*device, values);
    const Array<int> keyOf(*device, keys);
    Array<SixSums> all(*device, 1), byKey(*device, 2);
    dispatch(*device, [&](auto& d) { sixSums(d, n, in.view(), keyOf.view(), all.data(), byKey.view()); });
    EXPECT_TRUE(same(all.toHost().front(), expected)) << n;
    for (int k = 0; k < 2; ++k) EXPECT_TRUE(same(byKey.toHost()[k], expectedByKey[k])) << n << ", key " << k;
  }
}

TEST_P(ParallelTest, ExclusiveScanMatchesTheLoop) {
  for (const int n : kSizes) {
    const std::vector<int> values = randomInts(n, -3, 1000);
    std::vector<int> expected;
    int total = 0;
    for (const int v : values) expected.push_back(total), total += v;
    Array<int> in(*device, values), out(*device, n);
    dispatch(*device, [&](auto& d) { exclusiveScan(d, in.view(), out.view(), n); });
    EXPECT_EQ(out.toHost(), expected) << "n = " << n;
    EXPECT_EQ(in.toHost(), values) << "n = " << n;
    dispatch(*device, [&](auto& d) { exclusiveScan(d, in.view(), in.view(), n); });
    EXPECT_EQ(in.toHost(), expected) << "in place, n = " << n;
  }
}

template <class Key>
void testSort(Device& device, int n, Key max) {
  std::mt19937_64 random(static_cast<unsigned>(n));
  std::uniform_int_distribution<Key> pick(0, max);
  std::vector<std::pair<Key, int>> pairs(static_cast<std::size_t>(n));
  std::vector<Key> keys;
  std::vector<int> values;
  for (int i = 0; i < n; ++i) {
    keys.push_back(pick(random)), values.push_back(i);
    pairs[static_cast<std::size_t>(i)] = {keys.back(), i};
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  Array<Key> deviceKeys(device, keys);
  Array<int> deviceValues(device, values);
  dispatch(device, [&](auto& d) { stableSortByKey(d, deviceKeys.view(), deviceValues.view(), n); });
  keys = deviceKeys.toHost(), values = deviceValues.toHost();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    ASSERT_EQ(keys[i], pairs[i].first) << "n = " << n << ", most = " << max << ", i = " << i;
    ASSERT_EQ(values[i], pairs[i].second) << "n = " << n << ", most = " << max << ", i = " << i;
  }
}

TEST_P(ParallelTest, SortIsStableForBothWidthsOfKeys) {
  for (const int n : kSizes) {
    // One, a few, one digit, an odd number of digits, all bits.
    for (const std::uint32_t max : {0u, 3u, 255u, 0xffffffu, 0xffffffffu}) testSort(*device, n, max);
    for (const std::uint64_t max : {std::uint64_t{5}, std::uint64_t{1} << 39, ~std::uint64_t{0}}) {
      testSort(*device, n, max);
    }
  }
}

TEST_P(ParallelTest, CompactKeepsTheOrderAndStopsAtTheExactCount) {
  for (const int n : kSizes) {
    const std::vector<int> values = randomInts(n, 0, 1000);
    Array<int> in(*device, values);
    for (const int divisor : {1, 3, 500, 1009}) {
      for (const int exact : {n, n / 2}) {
        std::vector<int> expected;
        for (int i = 0; i < exact; ++i) {
          if (values[static_cast<std::size_t>(i)] % divisor == 0) expected.push_back(i);
        }
        Array<int> indices(*device, n);
        DeviceValue<int> kept(*device, -1);
        LooseCount count(*device, exact, n);
        dispatch(*device,
                 [&](auto& d) { keepMultiples(d, count, in.view(), divisor, indices.view(), kept.get()); });
        ASSERT_EQ(kept.read(), static_cast<int>(expected.size())) << "n = " << n << ", exact = " << exact;
        EXPECT_EQ(indices.toHost(kept.read()), expected) << "n = " << n << ", exact = " << exact;
      }
    }
  }
}

TEST_P(ParallelTest, CompactMayReplaceTheCountItReads) {
  const std::vector<int> values = randomInts(30011, 0, 9);
  Array<int> in(*device, values), indices(*device, 30011);
  DeviceValue<int> alive(*device, 20000);
  dispatch(*device, [&](auto& d) {
    keepMultiples(d, {30011, alive.get()}, in.view(), 5, indices.view(), alive.get());
  });
  const auto isKept = [](int v) { return v % 5 == 0; };
  EXPECT_EQ(alive.read(), std::count_if(values.begin(), values.begin() + 20000, isKept));
}

TEST_P(ParallelTest, ASteadyStateAllocatesNothing) {
  const int n = 100003;
  const std::vector<int> values = randomInts(n, 0, 1000);
  const std::vector<float> floats = randomFloats(n);
  Array<int> in(*device, values), order(*device, values);
  Array<float> floatsIn(*device, floats);
  DeviceValue<float> total(*device, 0);
  DeviceValue<int> kept(*device, 0);
  CellSort cells(*device);
  const auto step = [&] {
    Array<int> indices(*device, n);
    Array<std::uint32_t> keys(*device, n);
    keys.fillZero();
    dispatch(*device, [&](auto& d) {
      sum(d, n, floatsIn.view(), total.get());
      exclusiveScan(d, in.view(), indices.view(), n);
      stableSortByKey(d, keys.view(), order.view(), n);
      keepMultiples(d, n, in.view(), 3, indices.view(), kept.get());
      sortByCell(d, cells, n, 1001, in.view(), kept.get());
    });
  };
  // Twice, because what lives on takes over scratch memory of the first step.
  step();
  step();
  const MemoryUse warm = device->memoryUse();
  EXPECT_GT(warm.allocations, 0u);
  for (int i = 0; i < 20; ++i) step();
  EXPECT_EQ(device->memoryUse().allocations, warm.allocations);
  EXPECT_EQ(device->memoryUse().reserved, warm.reserved);
  EXPECT_EQ(device->memoryUse().inUse, warm.inUse);
  EXPECT_EQ(device->blockingReadbacks(), 0u);
}

TEST(CpuParallel, ResultsDoNotDependOnTheNumberOfThreads) {
  const int n = 300007;
  const std::vector<float> floats = randomFloats(n);
  const std::vector<int> ints = randomInts(n, 0, 5000);
  const auto run = [&](int threads) {
    CpuDevice device(threads);
    Array<float> values(device, floats);
    Array<int> keys(device, ints), indices(device, n);
    DeviceValue<int> kept(device, 0);
    keepMultiples(device, n, keys.view(), 7, indices.view(), kept.get());
    std::vector<int> result = indices.toHost(kept.read());
    CellSort cells(device);
    sortByCell(device, cells, n, 4000, keys.view(), kept.get());
    const ArrayView<const int> order = cells.order();
    result.insert(result.end(), order.data, order.data + kept.read());
    return std::pair(sumOf(device, n, values), result);
  };
  const auto [expectedSum, expectedOrder] = run(1);
  for (const int threads : {2, 4, 7}) {
    for (int repeat = 0; repeat < 5; ++repeat) {
      const auto [sum, order] = run(threads);
      EXPECT_EQ(std::memcmp(&sum, &expectedSum, sizeof sum), 0) << threads << " threads";
      EXPECT_EQ(order, expectedOrder) << threads << " threads";
    }
  }
}

TEST(CpuParallel, RangesDependOnTheSizeAndTheGrainAlone) {
  for (const int threads : {1, 3}) {
    CpuDevice device(threads);
    for (const std::int64_t n : {0, 1, 99, 100, 101, 100000}) {
      std::vector<int> visits(static_cast<std::size_t>(n), 0);
      detail::forRanges(device, n, 100, [&](std::int64_t begin, std::int64_t end) {
        EXPECT_EQ(begin % 100, 0);
        EXPECT_EQ(end, std::min(n, begin + 100));
        for (std::int64_t i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
      });
      EXPECT_EQ(visits, std::vector<int>(static_cast<std::size_t>(n), 1)) << "n = " << n;
    }
  }
}

TEST(CpuParallel, ExceptionsOfKernelsArrive) {
  CpuDevice device(4);
  for (const std::int64_t n : {1, 100, 500000}) {
    EXPECT_THROW(parallelFor(device, "throws", n,
                             [n](std::int64_t i) {
                               if (i == n - 1) throw std::runtime_error("last");
                             }),
                 std::runtime_error);
  }
}

}  // namespace
}  // namespace weir::test
