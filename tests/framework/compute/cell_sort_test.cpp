#include "framework/compute/cell_sort.h"

#include <algorithm>
#include <numeric>
#include <random>

#include "framework/compute/dispatch.h"
#include "tests/framework/compute/kernels.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

using CellSortTest = OnDevice;
WEIR_ON_EVERY_DEVICE(CellSortTest);

/// Sorts on the device and compares with a stable sort of the indices by key.
void expectSorted(Device& device, CellSort& sort, const std::vector<int>& keys, int cells, int exact) {
  const auto dropped = [&](int i) {
    const int key = keys[static_cast<std::size_t>(i)];
    return key < 0 || key >= cells;
  };
  std::vector<int> expected, lost;
  for (int i = 0; i < exact; ++i) (dropped(i) ? lost : expected).push_back(i);
  std::stable_sort(expected.begin(), expected.end(), [&](int a, int b) {
    return keys[static_cast<std::size_t>(a)] < keys[static_cast<std::size_t>(b)];
  });
  std::vector<int> start(static_cast<std::size_t>(cells) + 1, 0);
  for (const int i : expected) ++start[static_cast<std::size_t>(keys[static_cast<std::size_t>(i)]) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());

  Array<int> in(device, keys);
  // The count is replaced by the number kept, as a simulation that loses particles does it.
  Array<int> count(device, std::span<const int>(&exact, 1));
  dispatch(device, [&](auto& d) {
    sortByCell(d, sort, {static_cast<int>(keys.size()), count.data()}, cells, in.view(), count.data());
  });

  ASSERT_EQ(count.toHost()[0], static_cast<int>(expected.size()));
  ASSERT_EQ(sort.start().size, cells + 1);
  ASSERT_GE(sort.order().size, exact);
  std::vector<int> gotStart(start.size()), order(static_cast<std::size_t>(exact));
  device.download(gotStart.data(), sort.start().data, gotStart.size() * sizeof(int));
  if (exact > 0) device.download(order.data(), sort.order().data, order.size() * sizeof(int));
  EXPECT_EQ(gotStart, start);
  std::vector<int> behind(order.begin() + static_cast<std::ptrdiff_t>(expected.size()), order.end());
  order.resize(expected.size());
  EXPECT_EQ(order, expected);
  std::sort(behind.begin(), behind.end());
  EXPECT_EQ(behind, lost);
}

TEST_P(CellSortTest, MatchesAStableSort) {
  CellSort sort(*device);
  std::mt19937 random(3);
  for (const int n : {0, 1, 2, 31, 33, 1000, 1025, 8191, 100003, 1000007}) {
    for (const int cells : {1, 2, 40, 1000, 16383, 16384, 33000, 300000}) {
      if (n / cells > 5000) continue;  // crowded cells have their own test
      std::uniform_int_distribution<int> pick(-1, cells - 1);
      std::vector<int> keys(static_cast<std::size_t>(n));
      for (int& key : keys) key = pick(random);
      SCOPED_TRACE("n = " + std::to_string(n) + ", cells = " + std::to_string(cells));
      expectSorted(*device, sort, keys, cells, n);
      expectSorted(*device, sort, keys, cells, n / 3);
    }
  }
}

TEST_P(CellSortTest, CrowdedCellsKeepTheOrderOfIndices) {
  CellSort sort(*device);
  for (const int n : {31, 32, 33, 34, 35, 64, 1000, 20000}) {
    SCOPED_TRACE("n = " + std::to_string(n));
    expectSorted(*device, sort, std::vector<int>(static_cast<std::size_t>(n), 2), 5, n);
  }
}

TEST_P(CellSortTest, DropsEverythingAndNothing) {
  CellSort sort(*device);
  expectSorted(*device, sort, std::vector<int>(5000, -1), 8, 5000);
  expectSorted(*device, sort, std::vector<int>(5000, 8), 8, 5000);
  expectSorted(*device, sort, std::vector<int>(5000, -2147483647), 8, 5000);
  expectSorted(*device, sort, std::vector<int>(5, -1), 0, 5);
}

}  // namespace
}  // namespace weir::test
