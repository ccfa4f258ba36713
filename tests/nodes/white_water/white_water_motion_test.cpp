// How white water moves, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "nodes/white_water/dragged_motion.h"
#include "tests/nodes/white_water/given_fluid.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

using WhiteWaterMotion = OnDevice;

TEST(DraggedMotion, IsExactInStepsOfAnyLength) {
  const Vec3f a{0.5f, -9.8f, 0}, v0{3, 5, -1};
  for (const float rate : {0.0f, 0.01f, 1.5f, 40.0f})
    for (const int steps : {1, 7, 1000}) {
      const double time = 0.8, k = rate;
      Motion m{{0.1f, 0.2f, 0.3f}, v0};
      for (int s = 0; s < steps; ++s) m = dragged(m, a, rate, static_cast<float>(time / steps));
      for (int c = 0; c < 3; ++c) {
        const double g = a[c], v = v0[c], x0 = 0.1 * (c + 1);
        // v' = g − k·v, in double.
        const double x = k == 0 ? x0 + v * time + 0.5 * g * time * time
                                : x0 + g / k * time + (v - g / k) * (1 - std::exp(-k * time)) / k;
        const double end = k == 0 ? v + g * time : g / k + (v - g / k) * std::exp(-k * time);
        EXPECT_NEAR(m.position[c], x, 1e-4) << rate << " " << steps;
        EXPECT_NEAR(m.velocity[c], end, 1e-4) << rate << " " << steps;
      }
    }
}

TEST_P(WhiteWaterMotion, SprayFollowsItsParabolaWithDrag) {
  Given scene(*device);
  scene.fluid->positions = jitteredCube(5, 0.02f, 0, 1);
  scene.fluid->velocities = whirl(scene.fluid->positions, 0.02f, 3, {0, 4, 0});
  scene.fluid->onStep = [](GivenFluid& fluid, const StepContext& context) {
    if (context.index == 1) fluid.set().clear();
  };
  scene.assign(object({{"trapped_air", 4e6}}));
  scene.reset(0.005);
  scene.step(3);
  const auto before = scene.particles();
  scene.step(40);
  const auto after = scene.particles();
  ASSERT_GT(before.size(), 200u);
  EXPECT_EQ(after.size(), before.size());
  const double k = 1.5, t = 40 * 0.005;
  double farthest = 0;
  for (const auto& [id, start] : before) {
    const WhiteParticle& end = after.at(id);
    EXPECT_EQ(end.kind, kSpray);
    EXPECT_NEAR(end.age, start.age + t, 1e-5);
    EXPECT_NEAR(end.lifetime, start.lifetime - t, 1e-5);
    for (int c = 0; c < 3; ++c) {
      const double g = c == 1 ? -9.8 : 0, v = start.velocity[c];
      const double x = start.position[c] + g / k * t + (v - g / k) * (1 - std::exp(-k * t)) / k;
      farthest = std::max(farthest, std::abs(x - start.position[c]));
      EXPECT_NEAR(end.position[c], x, 1e-4 * std::max(1.0, std::abs(x)));
    }
  }
  EXPECT_GT(farthest, 0.4);
}

TEST_P(WhiteWaterMotion, ABubbleRisesAtItsTerminalSpeed) {
  for (const double speed : {0.25, 0.4}) {
    Given scene(*device);
    scene.fluid->positions = jitteredCube(16, 0.02f, 0, 1);
    scene.fluid->velocities.resize(scene.fluid->positions.size());
    for (std::size_t i = 0; i < scene.fluid->positions.size(); ++i) {
      const Vec3f& p = scene.fluid->positions[i];
      const bool inner = p.x > 0.1f && p.x < 0.2f && p.z > 0.1f && p.z < 0.2f && p.y > 0.08f && p.y < 0.12f;
      if (inner) scene.fluid->velocities[i] = {std::lround(p.x / 0.02f) % 2 == 0 ? 3.0f : -3.0f, 0, 0};
    }
    scene.fluid->onStep = [](GivenFluid& fluid, const StepContext& context) {
      if (context.index == 1) fluid.set().velocities().fillZero();
    };
    scene.assign(object({{"trapped_air", 4e6}, {"rise_speed", speed}}));
    scene.reset(0.002);
    scene.step(150);  // τ = 0.0128 s or 0.02 s
    const auto before = scene.particles();
    scene.step(50);
    const auto after = scene.particles();
    int bubbles = 0;
    for (const auto& [id, start] : before) {
      const auto end = after.find(id);
      if (end == after.end() || start.kind != kBubble || end->second.kind != kBubble) continue;
      ++bubbles;
      EXPECT_NEAR((end->second.position.y - start.position.y) / 0.1, speed, 0.02 * speed);
      EXPECT_EQ(end->second.lifetime, start.lifetime);
    }
    EXPECT_GT(bubbles, 20) << speed;
  }
}

TEST_P(WhiteWaterMotion, FoamGoesWithTheFluid) {
  Given scene(*device);
  scene.gravity = {};  // by which it would rise to the surface
  const Vec3f flow{1.2f, 0, 0.3f};
  scene.fluid->positions = jitteredCube(10, 0.02f, 0, 1);
  scene.fluid->velocities = whirl(scene.fluid->positions, 0.02f, 2, flow);
  scene.fluid->onStep = [&](GivenFluid& fluid, const StepContext& context) {
    if (context.index == 1) std::ranges::fill(fluid.velocities, flow);
    for (Vec3f& p : fluid.positions) p += float(context.dt) * flow;
    fluid.set().positions().assign(fluid.positions);
    fluid.set().velocities().assign(fluid.velocities);
  };
  scene.assign(object({{"trapped_air", 4e6}}));
  scene.reset(0.002);
  scene.step(5);
  int foam = 0;
  for (int k = 0; k < 20; ++k) {
    const auto before = scene.particles();
    scene.step(1);
    for (const auto& [id, now] : scene.particles()) {
      const auto last = before.find(id);
      if (now.kind != kFoam || last == before.end()) continue;
      ++foam;
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(now.velocity[c], flow[c], 1e-5);
        EXPECT_NEAR(now.position[c] - last->second.position[c], 0.002 * flow[c], 1e-6);
      }
    }
  }
  EXPECT_GT(foam, 2000);
}

TEST_P(WhiteWaterMotion, FoamComesToLieOnTheSurface) {
  constexpr float d = 0.02f, top = 9.5f * d;
  // The way of a step at rise_speed is a small part of half a spacing, and twice that.
  for (const auto& [dt, rise] : std::map<double, double>{{0.002, 0.25}, {0.01, 2}}) {
    Given scene(*device);
    scene.fluid->positions = jitteredCube(10, d, 0, 1);
    scene.fluid->velocities = whirl(scene.fluid->positions, d, 2, {});
    scene.fluid->onStep = [](GivenFluid& fluid, const StepContext& context) {
      if (context.index == 1) fluid.set().velocities().fillZero();
    };
    scene.assign(object({{"trapped_air", 4e4 / dt}, {"rise_speed", rise}}));
    scene.reset(dt);
    scene.step(2);
    const auto before = scene.particles();
    scene.step(static_cast<int>(std::lround(0.6 / dt)));
    int foam = 0, moved = 0;
    double mean = 0;
    for (const auto& [id, now] : scene.particles()) {
      const Vec3f& p = now.position;
      const bool inner = p.y > 7 * d && std::min(p.x, p.z) > 3 * d && std::max(p.x, p.z) < 6 * d;
      if (now.kind != kFoam || !inner) continue;
      ++foam;
      mean += double(p.y / d);
      moved += std::abs(before.at(id).position.y - p.y) > 0.3f * d ? 1 : 0;
      // Above a particle of the lattice the surface is higher than between four.
      EXPECT_NEAR(p.y / d, top / d, 0.4) << dt;
    }
    ASSERT_GT(foam, 30) << dt;
    EXPECT_NEAR(mean / foam, double(top / d), 0.1) << dt;
    EXPECT_GT(moved, foam / 4) << dt;
  }
}

WEIR_ON_EVERY_DEVICE(WhiteWaterMotion);

}  // namespace
}  // namespace weir::test
