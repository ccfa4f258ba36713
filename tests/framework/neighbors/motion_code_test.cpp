// Codes of places and velocities against the numbers they were made from.
#include "framework/neighbors/motion_code.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "framework/base/vec.h"

namespace weir {
namespace {

constexpr float kRadius = 0.015f;

struct Moving {
  Vec3f place, velocity;
};

/// Pairs of particles that may be neighbours, in all parts of a domain and far outside.
std::vector<std::pair<Moving, Moving>> pairs() {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto vector = [&](float scale) { return scale * Vec3f{unit(random), unit(random), unit(random)}; };
  std::vector<std::pair<Moving, Moving>> pairs;
  for (const float domain : {0.1f, 2.0f, 30.0f})
    for (int k = 0; k < 3000; ++k) {
      const Vec3f p = vector(domain);
      pairs.push_back({{p, vector(3)}, {p + vector(1.2f * kRadius), vector(3)}});
    }
  return pairs;
}

MotionCode::Other seen(const Moving& from, const Moving& other) {
  const MotionCode code(kRadius);
  return MotionCode::Sight(code.of(from.place, from.velocity))(code.of(other.place, other.velocity));
}

TEST(MotionCode, KeepsDifferencesOfPlacesToAFourThousandthOfTheRadius) {
  const double unit = MotionCode::Sight::unit(kRadius);
  for (const auto& [a, b] : pairs()) {
    const MotionCode::Other other = seen(a, b);
    // A coordinate of each is right to its unit, an 8192nd; a float far from the origin has coarser units
    // itself.
    const double coarse = 4 * std::abs(double(length(a.place))) * std::pow(2.0, -24);
    const double max = 2 * double(kRadius) / 8192 + coarse;
    EXPECT_NEAR(unit * other.away.x, double(b.place.x) - double(a.place.x), max);
    EXPECT_NEAR(unit * other.away.y, double(b.place.y) - double(a.place.y), max);
    EXPECT_NEAR(unit * other.away.z, double(b.place.z) - double(a.place.z), max);
  }
}

TEST(MotionCode, KeepsSixteenBitsOfVelocities) {
  for (const auto& [a, b] : pairs()) {
    const MotionCode::Other other = seen(a, b);
    const auto max = [](float one, float two) {
      return (std::abs(double(one)) + std::abs(double(two))) * std::pow(2.0, -15);
    };
    const Vec3f &v = a.velocity, &u = b.velocity;
    EXPECT_NEAR(other.faster.x, double(u.x) - double(v.x), max(u.x, v.x));
    EXPECT_NEAR(other.faster.y, double(u.y) - double(v.y), max(u.y, v.y));
    EXPECT_EQ(other.faster.z, u.z - v.z);
  }
}

TEST(MotionCode, TwoParticlesSeeEachOtherExactlyOpposite) {
  for (const auto& [a, b] : pairs()) {
    const MotionCode::Other there = seen(a, b), back = seen(b, a);
    EXPECT_EQ(there.away, -back.away);
    EXPECT_EQ(there.faster, -back.faster);
  }
}

TEST(MotionCode, TellsParticlesApartThatHaveMovedThreeRadii) {
  // Lists were made before the solver has moved particles; such a pair must not look near.
  const Moving a{{0.5f, 0.5f, 0.5f}, {}};
  for (const float way : {1.0f, 2.0f, 3.0f, -3.0f}) {
    const MotionCode::Other other = seen(a, {a.place + Vec3f{way * kRadius, 0, 0}, {}});
    EXPECT_NEAR(MotionCode::Sight::unit(kRadius) * other.away.x, way * kRadius, kRadius / 4096);
  }
}

TEST(MotionCode, OfPlacesFarAwayIsStillANumber) {
  const MotionCode code(kRadius);
  for (const float far : {1e9f, -1e30f}) {
    const MotionCode::Other other =
        MotionCode::Sight(code.of({far, 0, -far}, {1, 2, 3}))(code.of({0, 0, 0}, {1, 2, 3}));
    EXPECT_TRUE(std::isfinite(other.away.x) && std::isfinite(other.away.y) && std::isfinite(other.away.z));
  }
}

}  // namespace
}  // namespace weir
