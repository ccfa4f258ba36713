// Eight elements at a time, against one by one on the host.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "framework/compute/dispatch.h"
#include "tests/framework/compute/eight_kernel.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

struct Host {
  std::vector<float> one;
  std::vector<Vec3f> three;
  std::vector<Vec4f> four;
  int calls = 0;

  explicit Host(int size) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> number(-1, 1);
    for (int i = 0; i < size; ++i) {
      one.push_back(2 + number(random));
      three.push_back({number(random), number(random), number(random)});
      four.push_back({number(random), number(random), number(random), number(random)});
    }
  }

  /// The first `count` as the kernel leaves them.
  Host changed(int count) const {
    Host after = *this;
    after.calls = count;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      after.one[i] = std::sqrt(one[i]) + three[i].y;
      after.three[i] = {three[i].x / one[i], std::max(three[i].y, 0.0f) / one[i], three[i].z / one[i]};
      after.four[i] = {four[i].w, four[i].z, four[i].y, four[i].x + (i % 2 == 1 ? 1.0f : 0.0f)};
    }
    return after;
  }

  void changeOn(Device& device, int count) {
    Array<float> ones(device, one);
    Array<Vec3f> threes(device, three);
    Array<Vec4f> fours(device, four);
    Array<int> counter(device, 1);
    counter.fillZero();
    dispatch(device, [&](auto& d) {
      changeNumbers(d, count, {ones.view(), threes.view(), fours.view()}, counter.data());
    });
    one = ones.toHost(), three = threes.toHost(), four = fours.toHost();
    calls = counter.toHost().front();
  }
};

class EightTest : public OnDevice {};
WEIR_ON_EVERY_DEVICE(EightTest);

TEST_P(EightTest, IsTheSameAsOneByOne) {
  // Some of the last eight, and more than one thread takes; nothing behind the count is touched.
  for (const int count : {0, 1, 7, 8, 9, 64, 1029, 5003}) {
    Host numbers(count + 8);
    const Host before = numbers, expected = numbers.changed(count);
    numbers.changeOn(*device, count);
    EXPECT_EQ(numbers.calls, expected.calls);
    for (std::size_t i = 0; i < numbers.one.size(); ++i) {
      // CUDA's fastSqrt and division by a float may differ in the last bits, here those of the larger term.
      const float larger = std::max(std::sqrt(before.one[i]), std::abs(before.three[i].y));
      EXPECT_NEAR(numbers.one[i], expected.one[i], 4 * std::numeric_limits<float>::epsilon() * larger) << i;
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_FLOAT_EQ(numbers.three[i][axis], expected.three[i][axis]) << i;
      EXPECT_EQ(numbers.four[i], expected.four[i]) << i;
    }
  }
}

TEST(Eight, IsBitwiseTheSameForAllInstructionsOfTheCpu) {
  constexpr int kCount = 1234;
  const Host expected = Host(kCount).changed(kCount);
  for (const CpuIsa isa : usableCpuIsas()) {
    CpuDevice device(3, isa);
    Host numbers(kCount);
    numbers.changeOn(device, kCount);
    EXPECT_EQ(numbers.one, expected.one) << cpuIsaName(isa);
    EXPECT_EQ(numbers.three, expected.three) << cpuIsaName(isa);
  }
}

}  // namespace
}  // namespace weir::test
