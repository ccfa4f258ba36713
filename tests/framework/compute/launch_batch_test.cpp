#include <gtest/gtest.h>

#include <algorithm>

#include "framework/compute/dispatch.h"
#include "tests/framework/compute/kernels.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

class LaunchBatchTest : public OnDevice {
 protected:
  /// The squares of 0 … n-1 and one more each, asked for in one batch.
  void ask(Array<std::int64_t>& squares) {
    LaunchBatch batch(*device);
    squares.fillZero();
    dispatch(*device, [&](auto& d) { writeSquares(d, squares.size(), squares.view()); });
    batch.end();
  }
  static void expectSquares(const Array<std::int64_t>& squares) {
    const std::vector<std::int64_t> values = squares.toHost();
    for (std::size_t i = 0; i < values.size(); ++i)
      ASSERT_EQ(values[i], static_cast<std::int64_t>(i * i + 1)) << i << " of " << values.size();
  }
};
WEIR_ON_EVERY_DEVICE(LaunchBatchTest);

TEST_P(LaunchBatchTest, RepeatedWorkIsDoneEachTime) {
  Array<std::int64_t> squares(*device, 1000);
  for (int step = 0; step < 5; ++step) {
    ask(squares);
    expectSquares(squares);
    squares.fillZero();
  }
}

TEST_P(LaunchBatchTest, OtherArraysAndSizesAreSeen) {
  Array<std::int64_t> a(*device, 1000), b(*device, 70000);
  for (int step = 0; step < 12; ++step) {
    a.swap(b);
    ask(a);
    expectSquares(a);
    a.fillZero();
    Array<std::int64_t> growing(*device, 500 * (step + 1));
    ask(growing);
    expectSquares(growing);
  }
}

TEST_P(LaunchBatchTest, ResultsThatAreNeededEndTheBatch) {
  Array<std::int64_t> squares(*device, 300), others(*device, 200);
  for (int step = 0; step < 4; ++step) {
    LaunchBatch batch(*device);
    dispatch(*device, [&](auto& d) { writeSquares(d, squares.size(), squares.view()); });
    expectSquares(squares);
    dispatch(*device, [&](auto& d) { writeSquares(d, others.size(), others.view()); });
    batch.end();
    expectSquares(others);
    squares.fillZero();
    others.fillZero();
  }
}

// What a step uploads, such as where solids stand, neither ends the batch nor comes too early or late.
TEST_P(LaunchBatchTest, UploadsHaveTheirPlaceInTheBatch) {
  for (const std::size_t n : {256u, 257u, 700u, 960u, 961u, 8001u, 80000u}) {
    Array<int> values(*device, n), a(*device, n), b(*device, n);
    for (int step = 0; step < 6; ++step) {
      std::vector<int> first(n), second(n);
      for (std::size_t i = 0; i < n; ++i) first[i] = 1000 * step + int(i), second[i] = -int(i);
      LaunchBatch batch(*device);
      values.assign(first);
      device->copy(a.data(), values.data(), n * sizeof(int));
      if (step > 2) values.assign(second);
      device->copy(b.data(), values.data(), n * sizeof(int));
      const std::vector<int> expected = step > 2 ? second : first, expectedFirst = first;
      std::fill(first.begin(), first.end(), 0), std::fill(second.begin(), second.end(), 0);
      batch.end();
      EXPECT_EQ(a.toHost(), expectedFirst) << n;
      EXPECT_EQ(b.toHost(), expected) << n;
    }
  }
}

// A kernel that reads the count before it waits for the kernel before it must not do so where that writes it.
TEST_P(LaunchBatchTest, WhatTheKernelBeforeWritesIsNotReadAhead) {
  constexpr int kMax = 3000;
  Array<std::int64_t> squares(*device, kMax);
  Array<int> count(*device, 1);
  for (int step = 0; step < 8; ++step) {
    const int present = step % 2 == 0 ? kMax - step : 100 + step;
    squares.fillZero();
    LaunchBatch batch(*device);
    dispatch(*device, [&](auto& d) { writeSquaresOf(d, present, count.data(), squares.view()); });
    batch.end();
    const std::vector<std::int64_t> values = squares.toHost();
    for (int i = 0; i < kMax; ++i)
      ASSERT_EQ(values[std::size_t(i)], i < present ? std::int64_t{i} * i + 1 : 0)
          << i << " in step " << step;
  }
}

// What a batch fills and copies by kernels of its own: whole pieces of 16 bytes, and what is left.
TEST_P(LaunchBatchTest, FillsAndCopiesOfAnySize) {
  for (const int n : {1, 3, 4, 5, 63, 64, 255, 256, 257, 5000}) {
    Array<int> values(*device, n + 1), copies(*device, n + 1);
    for (int step = 0; step < 4; ++step) {
      values.assign(std::vector<int>(std::size_t(n) + 1, 7 + step));
      copies.fillZero();
      LaunchBatch batch(*device);
      device->fillBytes(values.data(), 0x11, (std::size_t(n) / 2) * sizeof(int));
      device->copy(copies.data(), values.data(), std::size_t(n) * sizeof(int));
      batch.end();
      std::vector<int> expected(std::size_t(n) + 1, 7 + step);
      std::fill_n(expected.begin(), n / 2, 0x11111111);
      ASSERT_EQ(values.toHost(), expected) << n;
      expected.back() = 0;
      ASSERT_EQ(copies.toHost(), expected) << n;
    }
  }
}

TEST_P(LaunchBatchTest, WhatIsDroppedLeavesTheDeviceUsable) {
  Array<std::int64_t> squares(*device, 300);
  try {
    const LaunchBatch batch(*device);
    dispatch(*device, [&](auto& d) { writeSquares(d, squares.size(), squares.view()); });
    throw simulationError("stopped");
  } catch (const Error&) {
  }
  ask(squares);
  expectSquares(squares);
}

}  // namespace
}  // namespace weir::test
