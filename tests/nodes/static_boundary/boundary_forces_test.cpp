// The forces that StaticBoundary reports, against hydrostatics and against the momentum of the fluid.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <string>

#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/static_boundary/static_boundary.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

constexpr double kGravity = 9.8, kWater = 1000;

class BoundaryForces : public OnDevice {};

struct Load {
  Vec3d force, torque;  // N, N·m, means from the frame before
};

Vec3d vectorOf(const Value& list) {
  return {list.asArray()[0].asDouble(), list.asArray()[1].asDouble(), list.asArray()[2].asDouble()};
}

Load loadOn(SimulatedScene& scene, const char* name) {
  NodeReport report;
  scene.node<StaticBoundary>(name).report(report);
  return {vectorOf(report.statistics["force"]), vectorOf(report.statistics["torque"])};
}

void nextFrame(SimulatedScene& scene) {
  const std::atomic<bool> stop{false};
  ASSERT_TRUE(scene->advanceFrame(stop));
}

constexpr double kSide = 0.2, kDepth = 0.3;  // m, of water that stands at a wall

/// That water, with more parameters of the wall.
std::string waterAtAWall(const std::string& more = "") {
  return R"({"weir": 1,
    "world": {"dt": 0.002, "frame_rate": 10, "duration": 0.2},
    "nodes": {
      "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.2, 0.3, 0.2]}},
      "tank": {"type": "StaticBoundary", "params": {"shape": "box", "min": [0, 0, 0], "max": [0.3, 0.6, 0.2],
                                                    "inverted": true, "report_forces": true}},
      "wall": {"type": "StaticBoundary", "params": {"shape": "box", "min": [0.2, -0.1, -0.1], "max": [0.5, 0.6, 0.3],
                                                    "report_forces": true, "pivot": [0.2, 0, 0.1])" +
         more + R"(}},
      "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "bulk_modulus": 5e5},
                "modules": {"solver": {"params": {"tolerance": 0.001, "iterations": 300,
                                                  "acceleration": "conjugate"}}}}},
    "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
              "wall.boundary -> water.boundaries"]})";
}

TEST_P(BoundaryForces, OfWaterAtRestAreHydrostatic) {
  SimulatedScene scene(*device, waterAtAWall());
  scene->reset();
  nextFrame(scene);
  nextFrame(scene);
  const Load tank = loadOn(scene, "tank"), wall = loadOn(scene, "wall");
  const double weight = kWater * kGravity * kSide * kSide * kDepth,
               onWall = kWater * kGravity * kDepth * kDepth / 2 * kSide;
  EXPECT_NEAR(tank.force.y + wall.force.y, -weight, 0.005 * weight);
  EXPECT_NEAR(wall.force.x, onWall, 0.02 * onWall);
  EXPECT_NEAR(tank.force.x, -onWall, 0.02 * onWall);
  // The centre of pressure is a third of the depth above the ground.
  EXPECT_NEAR(wall.torque.z, -onWall * kDepth / 3, 0.03 * onWall * kDepth / 3);
}

TEST_P(BoundaryForces, OfPartsOfAWallAreThoseOfTheWaterBeforeThem) {
  SimulatedScene scene(*device, waterAtAWall(R"(, "parts": [
    {"name": "foot", "min": [0, -1, -1], "max": [1, 0.1, 1]}, {"name": "knee", "min": [0, 0.1, -1], "max": [1, 0.2, 1]},
    {"name": "rest", "min": [0, 0.2, -1], "max": [1, 1, 1]}, {"name": "dry", "min": [0, 0.4, -1], "max": [1, 1, 1]}])"));
  scene->reset();
  nextFrame(scene);
  nextFrame(scene);
  NodeReport report;
  scene.node<StaticBoundary>("wall").report(report);
  const auto partOf = [&](const char* name) {
    const Value& part = report.statistics["parts"][name];
    return Load{vectorOf(*part.find("force")), vectorOf(*part.find("torque"))};
  };
  // N, of water from one height to another, in m.
  const auto pushed = [&](double from, double to) {
    const auto upTo = [&](double y) { return kDepth * y - y * y / 2; };
    return kWater * kGravity * kSide * (upTo(to) - upTo(from));
  };
  const double whole = pushed(0, kDepth);
  EXPECT_NEAR(partOf("foot").force.x, pushed(0, 0.1), 0.02 * whole);
  EXPECT_NEAR(partOf("knee").force.x, pushed(0.1, 0.2), 0.02 * whole);
  EXPECT_NEAR(partOf("rest").force.x, pushed(0.2, kDepth), 0.02 * whole);
  EXPECT_EQ(partOf("dry").force, (Vec3d{}));
  const Load wall = loadOn(scene, "wall");
  const Vec3d forces = partOf("foot").force + partOf("knee").force + partOf("rest").force;
  const Vec3d torques = partOf("foot").torque + partOf("knee").torque + partOf("rest").torque;
  EXPECT_NEAR(length(forces - wall.force), 0, 1e-9 * whole);
  EXPECT_NEAR(length(torques - wall.torque), 0, 1e-9 * whole);
}

TEST_P(BoundaryForces, OfPartsAreRefusedWhereTheyMeanNothing) {
  const auto messageOf = [&](const std::string& params) {
    const std::string scene =
        R"({"weir": 1, "nodes": {"wall": {"type": "StaticBoundary", "params": {"shape": "box", )" + params +
        "}}}}";
    return std::string(errorOf([&] { SimulatedScene(*device, scene); }).what());
  };
  const std::string part = R"({"name": "a", "min": [0, 0, 0], "max": [1, 1, 1]})";
  EXPECT_CONTAINS(messageOf(R"("parts": [)" + part + "]"), "no forces are reported");
  EXPECT_CONTAINS(messageOf(R"("report_forces": true, "parts": [)" + part + ", " + part + "]"),
                  "two parts are called 'a'");
  EXPECT_CONTAINS(messageOf(R"("report_forces": true, "parts": [{"max": [1, 1, 1]}])"), "has no name");
  EXPECT_CONTAINS(messageOf(R"("report_forces": true, "parts": [{"name": "a", "max": [1, 0, 1]}])"),
                  "no volume");
}

std::string splash(const std::string& solver) {
  return R"({"weir": 1,
    "world": {"dt": 0.002, "frame_rate": 10, "duration": 0.6},
    "nodes": {
      "block": {"type": "BoxSampler", "params": {"min": [0.02, 0.25, 0.02], "max": [0.2, 0.45, 0.2],
                                                 "velocity": [0.5, 0, 0.3]}},
      "tank": {"type": "StaticBoundary", "params": {"shape": "box", "min": [0, 0, 0], "max": [0.4, 0.8, 0.3],
                                                    "inverted": true, "report_forces": true, "friction": 0.2}},
      "ball": {"type": "StaticBoundary", "params": {"shape": "sphere", "position": [0.15, 0.1, 0.12],
                                                    "radius": 0.06, "report_forces": true, "restitution": 0.5}},
      "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "rest_steps": 0, "bulk_modulus": 1e6},
                "modules": {"solver": )" +
         solver + R"(}}},
    "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
              "ball.boundary -> water.boundaries"]})";
}

TEST_P(BoundaryForces, AreWhatAFluidInMotionLosesOfItsMomentum) {
  struct Case {
    const char* solver;
    double tolerance;
  };
  // The sums over pairs are opposite where iterations have converged; along conjugate directions always.
  for (const auto& [solver, tolerance] :
       {Case{R"({"params": {"iterations": 100}})", 0.01},
        Case{R"({"params": {"tolerance": 0.001, "iterations": 300, "acceleration": "conjugate"}})", 1e-3}}) {
    SimulatedScene scene(*device, splash(solver));
    scene->reset();
    const auto momentum = [&] {
      const ParticleSet& particles = scene.node<ParticleFluid>("water").fluid->set();
      Vec3d sum;
      for (const Vec3f& v : particles.velocities().toHost(particles.bound())) sum += Vec3d{v.x, v.y, v.z};
      return kWater * 0.02 * 0.02 * 0.02 * sum;
    };
    const double mass =
        kWater * 0.02 * 0.02 * 0.02 * double(scene.node<ParticleFluid>("water").particleCount());
    Vec3d before = momentum();
    for (int frame = 1; frame <= 6; ++frame) {
      nextFrame(scene);
      const Vec3d now = momentum(), onWalls = loadOn(scene, "tank").force + loadOn(scene, "ball").force;
      const Vec3d expected = mass * Vec3d{0, -kGravity, 0} - (now - before) / 0.1;
      const double scale = std::max(length(expected), mass * kGravity);
      EXPECT_NEAR(length(onWalls - expected), 0, tolerance * scale) << solver << ", frame " << frame;
      before = now;
    }
  }
}

TEST_P(BoundaryForces, OfABoundaryThatAnotherIncludesAreWarnedOf) {
  SimulatedScene scene(*device, R"({"weir": 1,
    "world": {"dt": 0.002, "frame_rate": 10, "duration": 0.1},
    "nodes": {
      "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.1, 0.1, 0.1]}},
      "post": {"type": "StaticBoundary", "params": {"shape": "sphere", "position": [0.2, 0.1, 0.1], "radius": 0.06,
                                                    "report_forces": true}},
      "tank": {"type": "StaticBoundary", "params": {"shape": "box", "min": [0, 0, 0], "max": [0.3, 0.6, 0.2],
                                                    "inverted": true}},
      "water": {"type": "ParticleFluid", "params": {"spacing": 0.02}}},
    "links": ["block.particles -> water.initial", "post.boundary -> tank.boundaries",
              "tank.boundary -> water.boundaries"]})");
  scene->reset();
  const auto isTold = [](const std::string& warning) {
    return warning.find("node 'post': forces on it are not reported where 'tank' includes it") !=
           std::string::npos;
  };
  EXPECT_EQ(std::count_if(scene.warnings().begin(), scene.warnings().end(), isTold), 1);
}

WEIR_ON_EVERY_DEVICE(BoundaryForces);

}  // namespace
}  // namespace weir::test
