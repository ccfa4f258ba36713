// Which particles are drawn as spray.
#include "plugins/views/lone_particles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "tests/support/devices.h"

namespace weir::test {
namespace {

using rendering::LoneParticles;

constexpr float kSpacing = 0.02f;

using LoneParticlesTest = OnDevice;

std::vector<int> onHost(Device& device, ArrayView<const int> numbers) {
  Array<int> copy(device, numbers.size);
  device.copy(copy.data(), numbers.data, static_cast<std::size_t>(numbers.size) * sizeof(int));
  return copy.toHost();
}

TEST_P(LoneParticlesTest, AreThoseWithoutNeighbours) {
  std::vector<Vec3f> places;
  // A block, a thread, and others far apart; on both sides of the origin.
  for (int i = 0; i < 1000; ++i)
    places.push_back(kSpacing * Vec3f{float(i % 10 - 5), float(i / 10 % 10 - 5), float(i / 100 - 5)});
  for (int i = 0; i < 100; ++i) places.push_back({1 + 0.95f * kSpacing * float(i), 3, -2});
  places.push_back({std::nanf(""), 0, 0});
  const std::size_t first = places.size();
  std::mt19937 random(3);
  std::uniform_real_distribution<float> part(0, 0.1f);
  for (int i = 0; i < 8000; ++i)
    places.push_back({-10 + 0.3f * float(i % 20) + part(random), 0.3f * float(i / 20 % 20) + part(random),
                      0.3f * float(i / 400) + part(random)});
  LoneParticles found(*device);
  found.find(Array<Vec3f>(*device, std::span<const Vec3f>(places)).view(), kSpacing);
  const std::vector<int> lone = onHost(*device, found.lone()), others = onHost(*device, found.others());
  EXPECT_EQ(lone.size() + others.size(), places.size());
  std::vector<int> count(places.size());
  for (const int i : lone) ++count[std::size_t(i)];
  for (const int i : others) ++count[std::size_t(i)];
  EXPECT_EQ(std::count(count.begin(), count.end(), 1), std::ptrdiff_t(places.size()));
  EXPECT_GT(lone.size(), 7900U);
  // But for the ends of the thread.
  for (const int i : lone) EXPECT_TRUE(std::size_t(i) >= first || i == 1000 || i == 1099) << i;
}

TEST_P(LoneParticlesTest, AreNoneOfNone) {
  LoneParticles found(*device);
  found.find({}, kSpacing);
  EXPECT_EQ(found.lone().size, 0);
  EXPECT_EQ(found.others().size, 0);
}

WEIR_ON_EVERY_DEVICE(LoneParticlesTest);

}  // namespace
}  // namespace weir::test
