// What viewers get of particles, on every back end.
#include "apps/studio/session/frame_kernels.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "framework/compute/dispatch.h"
#include "tests/support/devices.h"

namespace weir::studio {
namespace {

class FrameKernels : public test::OnDevice {
 protected:
  struct Quantized {
    Range<float> range;
    std::vector<std::uint16_t> values;
  };

  /// All, or those of these indices.
  template <class T>
  Quantized quantized(const std::vector<T>& values, const std::vector<int>& indices = {}) {
    const Array<T> from(*device, std::span<const T>(values));
    const Array<int> chosen(*device, std::span<const int>(indices));
    Array<Range<float>> range(*device, 1);
    Array<std::uint16_t> to(*device,
                            static_cast<std::int64_t>(indices.empty() ? values.size() : indices.size()));
    const ChosenParticles particles{chosen.view(), to.size()};
    dispatch(*device, [&](auto& on) {
      rangeOf(on, from.view(), particles, range.data());
      quantize(on, from.view(), particles, range.data(), to.view());
    });
    return {range.toHost().front(), to.toHost()};
  }
};
WEIR_ON_EVERY_DEVICE(FrameKernels);

TEST_P(FrameKernels, PointsAreOffByHalfAStepAtMost) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-3, 5);
  std::vector<Vec3f> points;
  for (int i = 0; i < 10000; ++i)
    points.push_back({place(random), 0.01f * place(random), 100 * place(random)});
  const Array<Vec3f> from(*device, std::span<const Vec3f>(points));
  Array<Range<Vec3f>> bounds(*device, 1);
  Array<std::uint16_t> to(*device, 3 * from.size());
  dispatch(*device, [&](auto& on) {
    boundsOf(on, from.view(), {{}, from.size()}, bounds.data());
    quantizePoints(on, from.view(), {{}, from.size()}, bounds.data(), to.view());
  });
  const Range<Vec3f> q = bounds.toHost().front();
  const std::vector<std::uint16_t> values = to.toHost();
  for (int axis = 0; axis < 3; ++axis) {
    float low = std::numeric_limits<float>::max(), high = -low;
    for (const Vec3f& p : points) low = std::min(low, p[axis]), high = std::max(high, p[axis]);
    EXPECT_EQ(q.low[axis], low);
    EXPECT_EQ(q.high[axis], high);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_NEAR(low + (high - low) * float(values[3 * i + static_cast<std::size_t>(axis)]) / 65535,
                  points[i][axis], 0.51f * (high - low) / 65535);
  }
}

TEST_P(FrameKernels, WhatIsNoNumberOrHasNoRangeIsZero) {
  const float inf = std::numeric_limits<float>::infinity();
  const Quantized q = quantized(std::vector<float>{1, NAN, 2, inf, -inf});
  EXPECT_EQ(q.range.low, 1);
  EXPECT_EQ(q.range.high, 2);
  EXPECT_EQ(q.values, (std::vector<std::uint16_t>{0, 0, 65535, 0, 0}));
  EXPECT_EQ(quantized(std::vector<float>{}).values.size(), 0u);
  EXPECT_EQ(quantized(std::vector<float>{3, 3}).values, (std::vector<std::uint16_t>{0, 0}));
  const float max = std::numeric_limits<float>::max();
  EXPECT_EQ(quantized(std::vector<float>{-max, max}).values, (std::vector<std::uint16_t>{0, 0}));
  const Quantized none = quantized(std::vector<float>{NAN, inf});
  EXPECT_GT(none.range.low, none.range.high);
  EXPECT_EQ(none.values, (std::vector<std::uint16_t>{0, 0}));
}

TEST_P(FrameKernels, WholeNumbersAndLengthsCountAsNumbers) {
  EXPECT_EQ(quantized(std::vector<int>{-5, 10, 0}).values, (std::vector<std::uint16_t>{0, 65535, 21845}));
  constexpr std::int64_t kLarge = std::int64_t{1} << 40;
  EXPECT_EQ(quantized(std::vector<std::int64_t>{-kLarge, 2 * kLarge, 0}).values,
            (std::vector<std::uint16_t>{0, 65535, 21845}));
  const Quantized lengths = quantized(std::vector<Vec3f>{{3, 4, 0}, {0, 0, 0}, {0, -1, 0}});
  EXPECT_EQ(lengths.range.high, 5);
  EXPECT_EQ(lengths.values, (std::vector<std::uint16_t>{65535, 0, 13107}));
}

TEST_P(FrameKernels, OnlyTheChosenCount) {
  constexpr int kEvery = 7, kParticles = 50000;
  std::vector<std::int64_t> ids;
  std::vector<float> values;
  for (std::int64_t i = 0; i < kParticles; ++i) {
    ids.push_back((i * 3) % kParticles);
    values.push_back(ids.back() % kEvery == 0 ? static_cast<float>(ids.back()) : 1e9f);
  }
  const Array<std::int64_t> from(*device, std::span<const std::int64_t>(ids));
  Array<int> indices(*device, from.size()), kept(*device, 1);
  dispatch(*device, [&](auto& on) { chooseEvery(on, from.view(), kEvery, indices.view(), kept.data()); });
  const std::int64_t count = kept.toHost().front();
  ASSERT_EQ(count, (kParticles - 1) / kEvery + 1);
  Array<std::int64_t> taken(*device, count);
  dispatch(*device, [&](auto& on) { takeIds(on, from.view(), {indices.view(), count}, taken.view()); });
  const std::vector<std::int64_t> chosen = taken.toHost();
  for (const std::int64_t id : chosen) ASSERT_EQ(id % kEvery, 0);
  const Quantized q = quantized(values, indices.toHost(count));
  EXPECT_EQ(q.range.low, 0);
  EXPECT_EQ(q.range.high, static_cast<float>((kParticles - 1) / kEvery * kEvery));
  for (std::size_t i = 0; i < chosen.size(); ++i)
    ASSERT_NEAR(q.range.high * float(q.values[i]) / 65535, float(chosen[i]), 0.51f * q.range.high / 65535);
}

}  // namespace
}  // namespace weir::studio
