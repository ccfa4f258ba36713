// The formulas give one number what they give each of several, and undo each other where they should.
#include "plugins/rendering/shading/formulas.h"

#include <gtest/gtest.h>

#include <random>

namespace weir::rendering {
namespace {

class Formulas : public testing::Test {
 protected:
  float any() { return part_(random_); }
  Vec3f anyVector() { return {any(), any(), any()}; }

  std::mt19937 random_{3};
  std::uniform_real_distribution<float> part_{-1, 1};
};

float lastOf(const Number& numbers) {
  return laneOf(numbers, kPixels - 1);
}

TEST_F(Formulas, GiveOneNumberTheBitsThatTheyGiveSeveral) {
  for (int i = 0; i < 200; ++i) {
    const Vec3f ray{any(), any(), -1}, center{any(), any(), any() - 2}, normal = normalized(anyVector());
    const float radius = 0.3f + 0.2f * any();
    float rest;
    Number rests;
    EXPECT_EQ(shading::distanceOfSphere(ray, center, radius, rest),
              lastOf(shading::distanceOfSphere(allOf(ray), allOf(center), Number(radius), rests)));
    EXPECT_EQ(rest, lastOf(rests));
    const Vec2f lines = shading::touchingLines(center.x, -center.z, radius);
    EXPECT_EQ(lines.x, lastOf(shading::touchingLines(Number(center.x), Number(-center.z), Number(radius)).x));
    EXPECT_EQ(shading::storedNormal(normal).y, lastOf(shading::storedNormal(allOf(normal)).y));
    EXPECT_EQ(shading::occlusionBy(center, normal, 3.0f),
              lastOf(shading::occlusionBy(allOf(center), allOf(normal), 3.0f)));
    EXPECT_GE(shading::fresnel(any(), 0.04f), 0.04f);
  }
}

TEST_F(Formulas, OfDepthsAndDistancesUndoEachOther) {
  const Vec4f projection{1, 1, -1.0004f, -0.20004f};  // from 0.1 m to 500 m
  for (const float distance : {0.11f, 1.0f, 7.5f, 100.0f})
    EXPECT_NEAR(shading::distanceOf(shading::depthOf(distance, projection), projection) / distance, 1, 1e-3f)
        << distance;
}

TEST_F(Formulas, PutNormalsIntoTheSquareFromZeroToOne) {
  for (int i = 0; i < 500; ++i) {
    const Vec2f stored = shading::storedNormal(normalized(anyVector()));
    EXPECT_GE(std::min(stored.x, stored.y), 0);
    EXPECT_LE(std::max(stored.x, stored.y), 1);
  }
  const Vec2f ahead = shading::storedNormal(Vec3f{0, 0, 1});
  EXPECT_EQ(ahead.x, 0.5f);
  EXPECT_EQ(ahead.y, 0.5f);
}

TEST_F(Formulas, KeepDarkLightAndBendBrightLightBelowOne) {
  EXPECT_EQ(shading::shoulder(0.8f), 0.8f);
  EXPECT_LT(shading::shoulder(0.9f), 0.9f);
  EXPECT_LE(shading::shoulder(100.0f), 1.0f);
  EXPECT_NEAR(shading::encoded(0.214041f), 0.5f, 1e-4f);  // the middle grey of sRGB
  EXPECT_NEAR(shading::encoded(0.001f), 0.01292f, 1e-6f);
}

}  // namespace
}  // namespace weir::rendering
