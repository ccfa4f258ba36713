// The default solver ends a step after a few iterations, and momentum must be kept all the same: pushes of
// pairs cancel, and what is left is what walls report.
#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <vector>

#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/semi_analytical_sfi/semi_analytical_sfi.h"
#include "nodes/static_boundary/static_boundary.h"
#include "tests/support/devices.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

constexpr double kGravity = 9.8, kWater = 1000, kSpacing = 0.04;
constexpr double kParticle = kWater * kSpacing * kSpacing * kSpacing;  // kg

class DefaultSolverMomentum : public OnDevice {};

/// A block of 30 cm in a tank, which it fills from wall to wall until the tank is longer.
constexpr const char* kBlock = R"({"weir": 1,
  "world": {"dt": 0.001, "frame_rate": 20, "duration": 0.3},
  "nodes": {
    "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.3, 0.3, 0.3]}},
    "tank": {"type": "StaticBoundary", "params": {"shape": "box", "min": [0, 0, 0], "max": [0.3, 0.5, 0.3],
                                                  "inverted": true, "report_forces": true}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.04}}},
  "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries"]})";

/// The same in a tank that is a mesh.
constexpr const char* kBlockInMesh = R"({"weir": 1,
  "world": {"dt": 0.001, "frame_rate": 20, "duration": 0.3},
  "nodes": {
    "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.3, 0.3, 0.3]}},
    "tank": {"type": "BoxMesh", "params": {"min": [0, 0, 0], "max": [0.3, 0.5, 0.3]}},
    "walls": {"type": "SemiAnalyticalSFI", "params": {"fill": "container"}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.04}}},
  "links": ["block.particles -> water.initial", "tank.surface -> walls.solids", "water.fluid -> walls.fluid"]})";

/// Two blobs that fly at each other, none of them through the middle, and no gravity.
constexpr const char* kBlobs = R"({"weir": 1,
  "world": {"gravity": [0, 0, 0], "dt": 0.003, "frame_rate": 20, "duration": 0.3},
  "nodes": {
    "left": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.2, 0.2, 0.2], "velocity": [2, 0, 0]}},
    "right": {"type": "BoxSampler", "params": {"min": [0.3, 0.08, 0], "max": [0.6, 0.28, 0.2],
                                               "velocity": [-1, 0.5, 0]}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.04, "rest_steps": 0}}},
  "links": ["left.particles -> water.initial", "right.particles -> water.initial"]})";

class Water {
 public:
  Water(Device& device, const char* text, const std::vector<std::string>& changes)
      : scene_(device, text, changes) {
    scene_->reset();
  }
  bool nextFrame() {
    const std::atomic<bool> goOn{false};
    return scene_->advanceFrame(goOn);
  }
  double mass() { return kParticle * double(water().particleCount()); }
  Vec3d momentum() {
    const ParticleSet& particles = water().fluid->set();
    Vec3d sum;
    for (const Vec3f& v : particles.velocities().toHost(particles.bound())) sum += Vec3d{v.x, v.y, v.z};
    return kParticle * sum;
  }
  /// N, on the tank, the mean since the frame before.
  Vec3d force() {
    NodeReport report;
    scene_.node<StaticBoundary>("tank").report(report);
    return vectorOf(report.statistics["force"]);
  }
  Vec3d forceOnMesh() {
    NodeReport report;
    scene_.node<SemiAnalyticalSFI>("walls").report(report);
    return vectorOf(*report.statistics["solids"].asArray().front().find("force"));
  }

 private:
  static Vec3d vectorOf(const Value& value) {
    const Value::Array& f = value.asArray();
    return {f[0].asDouble(), f[1].asDouble(), f[2].asDouble()};
  }
  ParticleFluid& water() { return scene_.node<ParticleFluid>("water"); }

  SimulatedScene scene_;
};

TEST_P(DefaultSolverMomentum, WaterAtRestPressesWithItsWeight) {
  for (const char* ratio : {"1.5", "2"})
    for (const char* dt : {"0.001", "0.003", "0.01"}) {
      Water run(*device, kBlock,
                {"water.support_ratio=" + std::string(ratio), "world.dt=" + std::string(dt),
                 "water.rest_steps=300"});
      Vec3d sum;
      int frames = 0;
      for (; run.nextFrame(); ++frames) sum += run.force();
      ASSERT_EQ(frames, 6);
      const double weight = kGravity * run.mass();
      // What is left is motion that has not ended; it was 2 to 4 % where pushes of pairs did not cancel.
      EXPECT_NEAR(-sum.y / frames, weight, 0.005 * weight) << ratio << ", " << dt;
    }
}

/// Of water whose tank is longer than it: it breaks, and has at each frame what weight and the tank gave.
void expectWhatWallsAndWeightGive(Water& run, Vec3d (Water::*force)(), const char* dt) {
  const double weight = kGravity * run.mass(), frame = 0.05;
  Vec3d expected = run.momentum();
  while (run.nextFrame()) {
    expected += frame * (Vec3d{0, -weight, 0} - (run.*force)());
    EXPECT_LT(length(run.momentum() - expected), 1e-3 * weight * 0.3) << dt;
  }
  EXPECT_GT(expected.x, 0.1 * weight * 0.3) << dt;
}

TEST_P(DefaultSolverMomentum, ADamGainsWhatWallsAndWeightGive) {
  for (const char* dt : {"0.001", "0.003", "0.01"}) {
    Water run(*device, kBlock,
              {"tank.max=[0.8, 0.8, 0.3]", "world.dt=" + std::string(dt), "water.rest_steps=0"});
    expectWhatWallsAndWeightGive(run, &Water::force, dt);
  }
}

// Up to the longest step that is not warned of; in edges and corners, too, where pushes turn as particles
// move.
TEST_P(DefaultSolverMomentum, AMeshGetsTheWeightOfWaterAtRest) {
  for (const char* dt : {"0.0025", "0.0075", "0.022"}) {
    Water run(*device, kBlockInMesh, {"world.dt=" + std::string(dt)});
    Vec3d sum;
    int frames = 0;
    for (; run.nextFrame(); ++frames) sum += run.forceOnMesh();
    ASSERT_EQ(frames, 6);
    const double weight = kGravity * run.mass();
    EXPECT_NEAR(-sum.y / frames, weight, 0.01 * weight) << dt;
  }
}

TEST_P(DefaultSolverMomentum, ADamInAMeshGainsWhatTheMeshAndWeightGive) {
  for (const char* dt : {"0.0025", "0.0075", "0.022"}) {
    Water run(*device, kBlockInMesh,
              {"tank.max=[0.8, 0.8, 0.3]", "world.dt=" + std::string(dt), "water.rest_steps=0"});
    expectWhatWallsAndWeightGive(run, &Water::forceOnMesh, dt);
  }
}

TEST_P(DefaultSolverMomentum, BlobsThatCollideKeepWhatTheyHave) {
  for (const char* dt : {"0.001", "0.003", "0.01"}) {
    Water run(*device, kBlobs, {"world.dt=" + std::string(dt)});
    const Vec3d before = run.momentum();
    const double scale = length(before);
    while (run.nextFrame()) EXPECT_LT(length(run.momentum() - before), 1e-5 * scale) << dt;
  }
}

WEIR_ON_EVERY_DEVICE(DefaultSolverMomentum);

}  // namespace
}  // namespace weir::test
