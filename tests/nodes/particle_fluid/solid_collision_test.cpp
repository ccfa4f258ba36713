#include "nodes/particle_fluid/solid_collision.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/devices.h"

namespace weir::test {
namespace {

/// A box, off the origin of its frame.
TriangleMesh box() {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.vertices.push_back({k & 1 ? 0.3f : 0.1f, k & 2 ? 0.1f : -0.1f, k & 4 ? 0.2f : -0.05f});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

struct Moved : RigidMotion {
  Pose poseAt(double) const override { return {}; }
  Vec3f pivotAt(double) const override { return {}; }
};

/// What is left out as far must be clear for the slow test, whatever the solid's way and turn.
TEST(SolidCollision, WhatIsFarIsClear) {
  constexpr float kGap = 0.01f;
  constexpr int kTrials = 20000, kPoints = 50;
  const auto device = openDevice("cpu", 1);
  const Moved motion;
  Solid solid(*device, box(), {}, motion, 0.05f);
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  const auto some = [&](float size) {
    return Vec3f{size * normal(random), size * normal(random), size * normal(random)};
  };
  const auto turn = [&](const Quatf& from, float by) {
    const Quatf q{from.w + by * normal(random), from.x + by * normal(random), from.y + by * normal(random),
                  from.z + by * normal(random)};
    const float size = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return Quatf{q.w / size, q.x / size, q.y / size, q.z / size};
  };
  int far = 0;
  for (int k = 0; k < kTrials; ++k) {
    SolidView view = solid.view(0, 0);
    view.begin = {turn({1, 0, 0, 0}, 1), some(0.1f)};
    view.end = {turn(view.begin.rotation, 0.2f), view.begin.translation + some(0.1f)};
    const Vec3f start = some(0.6f), position = start + some(0.2f);
    const Vec3f from = view.begin.toBody(start), to = view.end.toBody(position);
    if (!isFar(view, view.begin, kGap, start, position)) continue;
    ++far;
    const Aabb& bounds = view.clearance.bounds;
    for (int n = 0; n <= kPoints; ++n) {
      const Vec3f p = from + (float(n) / kPoints) * (to - from);
      ASSERT_GT(length(p - min(max(p, bounds.lo), bounds.hi)), kGap) << k;
    }
  }
  EXPECT_GT(far, kTrials / 10);
}

}  // namespace
}  // namespace weir::test
