// Fluids that meet rigid meshes: against double precision, closed forms of hydrostatics, and conservation.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>

#include "nodes/box_mesh/box_mesh.h"
#include "nodes/emitters/square_emitter.h"
#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/nodes/semi_analytical_sfi/solid_scene.h"
#include "tests/support/expect_error.h"
#include "tests/support/meshes.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

/// The integrals over the half-space y < 0 in closed form, times a factor, for the spiky kernel with s = 1.
ReferenceFluid::Wall halfSpace(const Vec3d& p, double radius, double factor) {
  const double q = p.y / radius;
  if (q >= 1) return {};
  const double t = 1 - q;
  return {factor * 0.5 * std::pow(t, 5) * (1 + 2 * q),
          {0, -factor * 1.5 * std::pow(t, 4) * (1 + 4 * q) / radius, 0},
          factor * 7.5 * std::pow(t, 4) / (radius * radius)};
}

/// A tank's worth of solid ground with its top at y = 0.
TriangleMesh ground() {
  return boxMesh({-2, -1, -2}, {2, 0, 2});
}

TEST(SemiAnalyticalSFI, OneStepOnTheGroundAgreesWithDoublePrecision) {
  for (const bool conservative : {true, false}) {
    constexpr float kSpacing = 0.02f, kRatio = 1.5f;
    const double dt = 2e-3;
    // Compressed and falling, all particles more than the collision gap above the ground.
    std::vector<Vec3f> positions =
        jitteredCube(10, 0.95f * kSpacing, 0.1f, 7, {-0.1f, 0.35f * kSpacing, -0.1f});
    const std::vector<Vec3f> velocities(positions.size(), Vec3f{0.1f, 0, 0.05f});
    ReferenceFluid reference{
        .spacing = kSpacing, .supportRatio = kRatio, .dt = dt, .conservative = conservative};
    // Φ of the plane at half a spacing is that of the lattice behind it.
    const WallKernel kernel = wallKernel(kRatio, Calibration::kLattice);
    EXPECT_NEAR(halfSpace({0, 0.5, 0}, kernel.radius, 1).phi,
                std::pow(kSpacing, 3) * reference.kernel(kSpacing) / reference.kernel(0) * 15 /
                        (std::numbers::pi * std::pow(kRatio * kSpacing, 3)) +
                    4 * std::pow(kSpacing, 3) * reference.kernel(std::numbers::sqrt2 * kSpacing) /
                        reference.kernel(0) * 15 / (std::numbers::pi * std::pow(kRatio * kSpacing, 3)),
                1e-6);
    reference.wall = [&](const Vec3d& p) { return halfSpace(p, kernel.radius * kSpacing, kernel.factor); };
    for (const Vec3f& p : positions) reference.positions.push_back(toDouble(p));
    for (const Vec3f& v : velocities) reference.velocities.push_back(toDouble(v));
    reference.step();
    for (const std::string& name : availableDevices()) {
      const auto device = openDevice(name);
      SolidScene scene(*device, positions, velocities,
                       object({{"spacing", kSpacing}, {"calibration", "lattice"}, {"mu", 1.0}}),
                       object({{"solver", object({{"params", object({{"conservative", conservative}})}})},
                               {"viscosity", object({{"enabled", false}})}}));
      SemiAnalyticalSFI& contact = scene.couple({ground()});
      scene.reset(dt);
      scene.step();
      ASSERT_EQ(scene.fluid().particleCount(), 1000);
      EXPECT_LT(largestDifference(scene.positions(), reference.positions) / kSpacing, 1e-4) << name;
      EXPECT_LT(largestDifference(scene.velocities(), reference.velocities) * dt / kSpacing, 1e-4) << name;
      scene.frame();
      const Vec3d impulse = dt * contact.forces->solids.front().force;
      EXPECT_NEAR(impulse.y, -reference.wallImpulse.y, 1e-4 * std::abs(reference.wallImpulse.y)) << name;
    }
  }
}

/// Two particles go around a rectangle in (distance of the two, height above the ground). What the fluid's
/// pressure does on the way is not work, as its forces are the gradient of one energy, those of walls
/// included.
TEST(SemiAnalyticalSFI, WorkOnAClosedWayPastAWallIsNone) {
  constexpr float kSpacing = 0.02f;
  constexpr int kPoints = 40;  // on each side of the rectangle
  constexpr double kCorners[5][2] = {{0.3, 0.7}, {0.3, 0.4}, {0.55, 0.4}, {0.55, 0.7}, {0.3, 0.7}};
  // All points of the way at once: pairs that do not reach each other.
  std::vector<Vec3f> positions;
  for (int side = 0; side < 4; ++side)
    for (int k = 0; k < kPoints; ++k) {
      const double t = (k + 0.5) / kPoints;
      const auto at = [&](int c) {
        return static_cast<float>((1 - t) * kCorners[side][c] + t * kCorners[side + 1][c]) * kSpacing;
      };
      const Vec3f middle{0.06f * float(k - kPoints / 2), at(1), 0.06f * float(side)};
      const Vec3f half{0.5f * at(0), 0, 0};
      positions.push_back(middle - half);
      positions.push_back(middle + half);
    }
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    // In so short a step, and with one iteration, velocities are forces.
    SolidScene scene(*device, positions, {}, object({{"spacing", kSpacing}}),
                     object({{"solver", object({{"params", object({{"iterations", 1}})}})},
                             {"viscosity", object({{"enabled", false}})}}));
    scene.gravity = {};
    scene.couple({ground()});
    scene.reset(1e-6);
    scene.step();
    const std::vector<Vec3f> forces = scene.velocities();
    ASSERT_EQ(forces.size(), positions.size());
    double work[4] = {};
    for (int side = 0; side < 4; ++side)
      for (int k = 0; k < kPoints; ++k) {
        const Vec3d first = toDouble(forces[2 * std::size_t(side * kPoints + k)]),
                    second = toDouble(forces[2 * std::size_t(side * kPoints + k) + 1]);
        const double apart = kCorners[side + 1][0] - kCorners[side][0],
                     up = kCorners[side + 1][1] - kCorners[side][1];
        work[side] += 0.5 * apart * (second.x - first.x) + up * (first.y + second.y);
      }
    // Down against the pressure, apart with it, up with less of it, and together again.
    EXPECT_LT(work[0], 0);
    EXPECT_GT(work[1], 0);
    EXPECT_GT(work[2], 0);
    EXPECT_LT(work[3], 0);
    EXPECT_NEAR(work[0] + work[1] + work[2] + work[3], 0, 2e-3 * work[1]) << name;
  }
}

struct MeanForces {
  Vec3d tank, solid, torque;
};

/// Means over the last of the steps.
MeanForces forcesAfter(SolidScene& scene, const SemiAnalyticalSFI& tank, const SemiAnalyticalSFI& solid,
                       int steps, int measured) {
  scene.step(steps);
  scene.frame();
  scene.step(measured);
  scene.frame();
  return {tank.forces->solids[0].force, solid.forces->solids[0].force, solid.forces->solids[0].torque};
}

TEST(SemiAnalyticalSFI, HydrostaticForceOnAWall) {
  constexpr float kSpacing = 0.02f, kSide = 0.2f, kDepth = 0.3f;
  CpuDevice device;
  // In no order, as crystals bear more weight upright than sideways.
  std::vector<Vec3f> positions = block(kSpacing, {}, {kSide, kDepth, kSide});
  const std::vector<Vec3f> offsets = randomVelocities(positions.size(), 0.2f * kSpacing, 5);
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += offsets[i];
  SolidScene scene = settling(device, kSpacing, positions);
  SemiAnalyticalSFI& tank =
      scene.couple({boxMesh({0, 0, 0}, {0.3f, 0.6f, kSide})}, object({{"fill", "container"}}));
  // The wall at x = kSide, and nothing else of the tank.
  SemiAnalyticalSFI& wall = scene.couple({boxMesh({kSide, 0, 0}, {0.3f, 0.6f, kSide})},
                                         object({{"pivot", Value::Array{kSide, 0, 0.5f * kSide}}}));
  scene.reset(kSettlingDt);
  ASSERT_EQ(scene.fluid().particleCount(), 1500);
  const MeanForces mean = forcesAfter(scene, tank, wall, 400, 200);
  const double weight = kWater * kGravity * kSide * kSide * kDepth;
  const double onWall = kWater * kGravity * kDepth * kDepth / 2 * kSide;
  EXPECT_NEAR(mean.solid.x, onWall, 0.03 * onWall);
  // Its centre of pressure is a third of the depth above the ground; a force along x at height y turns by -y.
  EXPECT_NEAR(mean.torque.z, -onWall * kDepth / 3, 0.05 * onWall * kDepth / 3);
  EXPECT_NEAR(mean.tank.y + mean.solid.y, -weight, 0.01 * weight);
}

TEST(SemiAnalyticalSFI, BuoyancyOfAHeldSphere) {
  constexpr float kSpacing = 0.02f, kSide = 0.26f, kRadius = 0.08f;
  CpuDevice device;
  SolidScene scene = settling(device, kSpacing, block(kSpacing, {}, {kSide, kSide, kSide}));
  SemiAnalyticalSFI& tank =
      scene.couple({boxMesh({0, 0, 0}, {kSide, 0.6f, kSide})}, object({{"fill", "container"}}));
  TriangleMesh sphere = icosphere(3, kRadius);
  sphere.transform(1, {}, {0.5f * kSide, 0.12f, 0.5f * kSide});
  SemiAnalyticalSFI& held = scene.couple({sphere});
  scene.reset(kSettlingDt);
  const MeanForces mean = forcesAfter(scene, tank, held, 300, 150);
  const double buoyancy = kWater * kGravity * sphere.volume();
  // A tenth of a spacing is 4 % of this sphere's radius and 12 % of its volume.
  EXPECT_NEAR(mean.solid.y, buoyancy, 0.12 * buoyancy);
  EXPECT_NEAR(mean.tank.y + mean.solid.y,
              -double(scene.fluid().particleCount()) * kWater * kGravity * std::pow(kSpacing, 3),
              0.01 * std::abs(mean.tank.y));
}

TEST(SemiAnalyticalSFI, CarvesWhatStartsInsideAndCountsIt) {
  constexpr float kSpacing = 0.02f, kRadius = 0.1f, kGap = 0.25f * kSpacing;
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const std::vector<Vec3f> positions = jitteredCube(16, kSpacing, 0.3f, 3, {-0.15f, -0.15f, -0.15f});
    for (const char* fill : {"solid", "container", "sheet"}) {
      SolidScene scene(*device, positions, {}, object({{"spacing", kSpacing}}));
      SemiAnalyticalSFI& contact = scene.couple({icosphere(4, kRadius)}, object({{"fill", fill}}));
      scene.reset(1e-3);
      // The icosphere's faces lie a little inside the sphere.
      const double sagitta = icosphereSagitta(icosphere(4, kRadius), kRadius);
      int min = 0, max = 0;
      for (const Vec3f& p : positions) {
        const double r = length(toDouble(p));
        const double outside = kRadius + kGap, inside = kRadius - kGap;
        const bool kept = fill[0] != 'c' && r > outside, keptInside = fill[0] != 's' || fill[1] == 'h';
        min += kept || (keptInside && r < inside - sagitta);
        max += (fill[0] != 'c' && r > outside - sagitta) || (keptInside && r < inside);
      }
      NodeReport report;
      contact.report(report);
      const std::int64_t left = scene.fluid().particleCount();
      EXPECT_GE(left, min) << fill;
      EXPECT_LE(left, max) << fill;
      EXPECT_LT(max - min, 60) << fill;
      EXPECT_EQ(report.statistics["particles_carved"].asInt(), std::int64_t(positions.size()) - left);
    }
  }
}

/// A jet that starts half in a block that moves out of its way.
TEST(SemiAnalyticalSFI, CarvesWhatIsBornInside) {
  constexpr float kSpacing = 0.02f;
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    SolidScene scene(*device, {}, {}, object({{"spacing", kSpacing}, {"calibration", "lattice"}}));
    scene.gravity = {};
    auto& jet = static_cast<SquareEmitter&>(scene.graph().add(std::make_unique<SquareEmitter>(), "jet"));
    jet.assignAll(object({{"width", 0.2}, {"height", 0.2}, {"speed", 1.99}}), {"test", "", ""});
    scene.graph().link(SceneGraph::parseLink("jet.particles -> water.emitters"));
    // After 0.1 s its side is at x = 0.11, out of the jet.
    SemiAnalyticalSFI& block =
        scene.couple({boxMesh({0.01f, -1, -1}, {1, 1, 1})}, object({{"velocity", Value::Array{1, 0, 0}}}));
    scene.reset(0.01);
    scene.step();
    scene.frame();
    // One layer of 10 by 10 leaves in each step: those at x < 0.01 - d/4 = 0.005 have room, which are 5
    // columns.
    EXPECT_EQ(scene.fluid().particleCount(), 50);
    for (const Vec3f& p : scene.fluid().fluid->set().positions().toHost(50)) EXPECT_LT(p.x, 0);
    NodeReport report;
    block.report(report);
    EXPECT_EQ(report.statistics["particles_carved"].asInt(), 50);
    EXPECT_EQ(report.events.front().count, 50);
    scene.step(19);
    scene.frame();
    // Layer k leaves in step k; the column at x = 0.01·(2c + 1) has room when 0.01 + 0.01·k > x + d/4.
    int expected = 0;
    for (int k = 0; k < 20; ++k)
      for (int c = -5; c < 5; ++c) expected += c < 0 || 0.01 + 0.01 * k > 0.01 * (2 * c + 1) + 0.005 ? 10 : 0;
    EXPECT_EQ(scene.fluid().particleCount(), expected) << name;
  }
}

/// Single particles in a closed sheet that moves and turns: none may leave it, and none outside may enter.
TEST(SemiAnalyticalSFI, NothingPassesAMovingSheet) {
  constexpr float kSpacing = 0.02f;
  std::vector<Vec3f> positions, velocities;
  for (const Vec3f& p : jitteredCube(8, 0.05f, 0.4f, 11, {-0.175f, -0.175f, -0.175f})) {
    if (length(p) > 0.25f && length(p) < 0.35f) continue;
    positions.push_back(p);
  }
  for (const Vec3f& p : jitteredCube(4, 0.4f, 0.2f, 12, {-0.6f, -0.6f, -0.6f}))
    if (length(p) > 0.35f) positions.push_back(p);
  velocities = randomVelocities(positions.size(), 100, 13);
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    SolidScene scene(*device, positions, velocities, object({{"spacing", kSpacing}}));
    SemiAnalyticalSFI& shell =
        scene.couple({icosphere(2, 0.3f)}, object({{"fill", "sheet"},
                                                   {"friction", 0.1},
                                                   {"velocity", Value::Array{3, 1, -2}},
                                                   {"angular_velocity", Value::Array{9, 30, 5}},
                                                   {"pivot", Value::Array{0.1, 0, 0}}}));
    scene.reset(1e-3);
    const std::size_t before = positions.size();
    for (int k = 1; k <= 300; ++k) {
      scene.step();
      const std::vector<Vec3f> now = scene.positions();
      ASSERT_EQ(now.size(), before) << name;
      if (k % 10 != 0) continue;
      const Pose pose = shell.poseAt(k * 1e-3);
      for (std::size_t i = 0; i < now.size(); ++i) {
        const bool wasInside = length(positions[i]) < 0.3f;
        const double winding = slowWindingNumber(icosphere(2, 0.3f), pose.toBody(now[i]));
        ASSERT_EQ(winding > 0.5, wasInside) << name << " particle " << i << " step " << k;
      }
    }
  }
}

/// A layer of water that slides on the ground loses μ·g of its speed each second.
TEST(SemiAnalyticalSFI, FrictionIsCoulombs) {
  constexpr float kSpacing = 0.02f, kSpeed = 2, kFriction = 0.3f;
  for (const std::string& name : availableDevices()) {
    for (const double dt : {5e-4, 2e-3}) {
      const auto device = openDevice(name);
      std::vector<Vec3f> positions = block(kSpacing, {-0.2f, 0, -0.2f}, {0.2f, kSpacing, 0.2f});
      SolidScene scene(*device, positions, std::vector<Vec3f>(positions.size(), Vec3f{kSpeed, 0, 0}),
                       object({{"spacing", kSpacing}}));
      scene.couple({ground()}, object({{"friction", kFriction}}));
      scene.reset(dt);
      scene.step(int(std::lround(0.3 / dt)));
      double mean = 0;
      for (const Vec3f& v : scene.velocities()) mean += double(v.x) / double(positions.size());
      const double expected = kSpeed - kFriction * kGravity * 0.3;
      EXPECT_NEAR(mean, expected, 0.05 * (kSpeed - expected)) << name << " dt " << dt;
    }
  }
}

TEST(SemiAnalyticalSFI, NoSlipIsARatePerSecond) {
  constexpr float kSpacing = 0.02f;
  CpuDevice device;
  for (const double dt : {5e-4, 2e-3}) {
    // One particle at rest above the ground, in weightlessness.
    SolidScene scene(device, {{0, 0.3f * kSpacing, 0}}, {{1, 0, 0}}, object({{"spacing", kSpacing}}));
    scene.gravity = {};
    scene.couple({ground()}, object({{"no_slip", 10}, {"velocity", Value::Array{0.25, 0, 0}}}));
    scene.reset(dt);
    scene.step(int(std::lround(0.1 / dt)));
    const double q = 0.3 / wallKernel(1.5, Calibration::kPacking).radius,
                 touch = std::pow(1 - q, 5) * (1 + 2 * q);
    EXPECT_NEAR(scene.velocities()[0].x, 0.25 + 0.75 * std::exp(-10 * 0.1 * touch), 0.005);
  }
}

/// Of all corners of a box that moves and turns in every way, none goes farther than cfl·d in a step.
TEST(SemiAnalyticalSFI, StepsFollowTheSolids) {
  constexpr const char* kScene = R"({
    "weir": 1,
    "world": { "gravity": [0, 0, 0], "dt": 0.5, "cfl": 0.5, "frame_rate": 2, "duration": 1 },
    "nodes": {
      "block": { "type": "BoxSampler", "params": { "min": [9, 9, 9], "max": [9.2, 9.2, 9.2] } },
      "box": { "type": "BoxMesh", "params": { "min": [-0.1, -0.2, -0.3], "max": [0.1, 0.2, 0.3] } },
      "contact": { "type": "SemiAnalyticalSFI", "params": {
        "velocity": [0.1, 0, 0], "angular_velocity": [0, 1, 0.5], "pivot": [0.1, 0, 0],
        "position": { "keyframes": [[0, [0, 0, 0]], [0.3, [0, 0.6, 0]], [0.7, [0, 0.6, 0]]] },
        "rotation": { "keyframes": [[0.6, [0, 0, 0]], [0.8, [90, 20, 0]]] } } },
      "water": { "type": "ParticleFluid", "params": { "spacing": 0.1 } }
    },
    "links": [ "block.particles -> water.initial", "water.fluid -> contact.fluid",
               "box.surface -> contact.solids" ]
  })";
  CpuDevice device;
  SimulatedScene scene(device, kScene);
  scene->reset();
  const auto& contact = scene.node<SemiAnalyticalSFI>("contact");
  const std::atomic<bool> goOn = false;
  double time = 0, farthest = 0;
  const auto look = [&] {
    const Pose before = contact.poseAt(time), after = contact.poseAt(scene->time());
    for (const Vec3f& corner : scene.node<BoxMesh>("box").surface->vertices)
      farthest = std::max(farthest, double(length(after.toWorld(corner) - before.toWorld(corner))));
    time = scene->time();
  };
  while (scene->advanceFrame(goOn, look)) {
  }
  EXPECT_EQ(scene->time(), 1);
  EXPECT_LE(farthest, 0.05 * (1 + 1e-4));
  EXPECT_GT(farthest, 0.02);
  EXPECT_LT(scene->stepsDone(), 300);
}

TEST(SemiAnalyticalSFI, SaysWhatIsWrongWithMeshes) {
  CpuDevice device;
  TriangleMesh holed = boxMesh({}, {1, 1, 1});
  holed.triangles.pop_back();
  SolidScene scene(device, {{5, 5, 5}}, {}, object({}));
  scene.couple({holed});
  scene.reset(1e-3);
  ASSERT_EQ(scene.warnings().size(), 1u);
  EXPECT_CONTAINS(scene.warnings()[0], "11 triangles");
  EXPECT_CONTAINS(scene.warnings()[0], "3 open edges");
  EXPECT_CONTAINS(scene.warnings()[0], "sheet");
}

}  // namespace
}  // namespace weir::test
