// Bodies without a fluid, at walls, and what is refused.
#include "nodes/rigid_body/rigid_body.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>

#include "framework/graph/registry.h"
#include "framework/graph/scene_graph.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/fluid_scene.h"
#include "tests/support/given_mesh.h"
#include "tests/support/meshes.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

/// A box of half a metre times 0.2 m times 0.3 m, whose parameters are given, above a plane if it is given.
std::string bodyScene(const std::string& body, const std::string& plane = "") {
  const std::string node =
      plane.empty() ? ""
                    : R"(, "floor": {"type": "StaticBoundary", "params": {"shape": "plane", )" + plane + "}}";
  const std::string link = plane.empty() ? "" : R"(, "floor.boundary -> body.walls")";
  return R"({"weir": 1, "world": {"gravity": [0, -10, 0], "dt": 0.005, "frame_rate": 20, "duration": 5},
    "nodes": {"box": {"type": "BoxMesh", "params": {"min": [-0.25, -0.1, -0.15], "max": [0.25, 0.1, 0.15]}},
              "body": {"type": "RigidBody", "params": {)" +
         body + "}}" + node + R"(}, "links": ["box.surface -> body.mesh")" + link + "]}";
}

BodyState stateAfter(SimulatedScene& scene, int frames) {
  const std::atomic<bool> stop = false;
  for (int k = 0; k < frames; ++k) scene->advanceFrame(stop);
  return scene.node<RigidBody>("body").state();
}

TEST(RigidBody, FallsAndIsReported) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    SimulatedScene scene(*device, bodyScene(R"("density": 500, "position": [1, 2, 3], "velocity": [1, 0, 0],
                                               "angular_velocity": [0, 2, 0])"));
    scene->reset();
    const RigidBody& body = scene.node<RigidBody>("body");
    EXPECT_NEAR(body.massOf().mass, 15, 1e-4);
    EXPECT_EQ(body.pivotAt(0), (Vec3f{1, 2, 3}));
    const BodyState state = stateAfter(scene, 20);
    EXPECT_NEAR(state.velocity.y, -10, 1e-9);
    EXPECT_NEAR(state.center.x, 2, 1e-9);
    EXPECT_NEAR(state.center.y, 2 - 10 * 0.005 * 0.005 * 200 * 201 / 2, 1e-9);
    // It turns about its own axis.
    EXPECT_NEAR(dot(rotate(state.rotation, Vec3d{1, 0, 0}), Vec3d{std::cos(2), 0, -std::sin(2)}), 1, 1e-6);
    EXPECT_EQ(body.poseAt(1), poseOf(body.massOf(), state));
    // At the frame before, for pictures of motion.
    EXPECT_NEAR(body.poseAt(0.95).translation.x, 1.95, 1e-6);
    EXPECT_EQ(body.poseAt(0).translation, (Vec3f{1, 2, 3}));
    NodeReport report;
    scene.node<RigidBody>("body").report(report);
    EXPECT_EQ(report.statistics["velocity"].asArray()[1].asDouble(), state.velocity.y);
    EXPECT_NEAR(report.statistics["angular_velocity"].asArray()[1].asDouble(), 2, 1e-6);
  }
}

/// Without a torque the angular momentum and the energy stay, whichever way the body tumbles.
TEST(RigidBody, TumblesAsATopWithoutTorque) {
  const auto device = openDevice("cpu");
  SimulatedScene scene(*device, bodyScene(R"("density": 500, "angular_velocity": [0.02, 0.01, 6])"));
  scene->reset();
  const RigidBody& body = scene.node<RigidBody>("body");
  const auto energy = [&](const BodyState& at) {
    return 0.5 * dot(at.spin, twistOf(body.massOf(), at).angular);
  };
  const BodyState before = body.state(), after = stateAfter(scene, 100);
  EXPECT_EQ(after.spin, before.spin);
  EXPECT_NEAR(energy(after) / energy(before), 1, 1e-6);
  // About the axis of the middle moment it turns over.
  EXPECT_GT(length(twistOf(body.massOf(), after).angular - twistOf(body.massOf(), before).angular), 0.01);
}

/// F/m and I⁻¹·T, besides gravity, as keyframes say.
TEST(RigidBody, AppliedForcesMoveIt) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    SimulatedScene scene(*device, bodyScene(R"("mass": 3, "applied_force": [1.5, 30, 0],
        "applied_torque": {"keyframes": [[0, [0, 0.2, 0]], [1, [0, 0.2, 0]], [1.0001, [0, 0, 0]]]})"));
    scene->reset();
    const BodyState state = stateAfter(scene, 40);
    EXPECT_NEAR(state.velocity.x, 2 * 0.5, 1e-9);
    EXPECT_NEAR(state.velocity.y, 0, 1e-9);
    EXPECT_NEAR(state.center.x, 0.5 * 0.5 * 4 + 0.5 * 0.5 * 2 * 0.005, 1e-9);
    EXPECT_NEAR(state.spin.y, 0.2, 0.2 * 0.01);  // a step more or less
  }
}

TEST(RigidBody, FixedAxesTakeUpAppliedForces) {
  const auto device = openDevice("cpu");
  SimulatedScene scene(*device, bodyScene(R"("mass": 3, "fixed": "xy", "fixed_rotation": "y",
      "applied_force": [1, 1, 3], "applied_torque": [0, 5, 0])"));
  scene->reset();
  const BodyState state = stateAfter(scene, 20);
  EXPECT_EQ(state.velocity.x, 0);
  EXPECT_EQ(state.velocity.y, 0);
  EXPECT_NEAR(state.velocity.z, 1, 1e-9);
  EXPECT_EQ(state.spin.y, 0);
}

TEST(RigidBody, IsPlacedBetweenSteps) {
  const auto device = openDevice("cpu");
  SimulatedScene scene(*device, bodyScene(R"("mass": 3, "fixed": "z")"));
  scene->reset();
  auto& body = const_cast<RigidBody&>(scene.node<RigidBody>("body"));
  stateAfter(scene, 3);
  const double half = std::sqrt(0.5);
  body.placeMesh({half, 0, half, 0}, {1, 2, 3}, {{4, 5, 6}, {0, 7, 0}});
  EXPECT_EQ(body.state().center, (Vec3d{1, 2, 3}));
  EXPECT_EQ(body.state().velocity, (Vec3d{4, 5, 0}));
  EXPECT_NEAR(twistOf(body.massOf(), body.state()).angular.y, 7, 1e-12);
  EXPECT_EQ(body.poseAt(0.15).translation, (Vec3f{1, 2, 3}));
  EXPECT_NEAR(stateAfter(scene, 20).center.x, 5, 1e-9);
  EXPECT_CONTAINS(errorOf([&] {
                    body.placeMesh({2, 0, 0, 0}, {}, {});
                  }).what(),
                  "a quaternion w, x, y, z of length 1");
  EXPECT_CONTAINS(errorOf([&] { body.placeMesh({}, {NAN, 0, 0}, {}); }).what(), "not finite");
}

TEST(RigidBody, FixedAxesHoldIt) {
  const auto device = openDevice("cpu");
  SimulatedScene scene(*device, bodyScene(R"("mass": 3, "fixed": "yz", "fixed_rotation": "xyz",
                                             "velocity": [1, 2, 3], "angular_velocity": [1, 2, 3])"));
  scene->reset();
  const BodyState state = stateAfter(scene, 20);
  EXPECT_NEAR(state.center.x, 1, 1e-9);
  EXPECT_EQ(state.center.y, 0);
  EXPECT_EQ(state.center.z, 0);
  EXPECT_EQ(state.rotation, Quatd{});
}

TEST(RigidBody, RestsOnAFloorWithoutJitter) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    SimulatedScene scene(*device, bodyScene(R"("mass": 3, "position": [0, 0.3, 0], "rotation": [0, 30, 20])",
                                            R"("normal": [0, 1, 0])"));
    scene->reset();
    BodyState state = stateAfter(scene, 60);
    for (int k = 0; k < 10; ++k) {
      EXPECT_NEAR(state.center.y, 0.1, 1e-6) << name;
      EXPECT_LT(length(state.velocity), 1e-4) << name;
      EXPECT_LT(length(twistOf(scene.node<RigidBody>("body").massOf(), state).angular), 1e-3) << name;
      const BodyState next = stateAfter(scene, 1);
      EXPECT_LT(length(next.center - state.center), 1e-6) << name;
      state = next;
    }
  }
}

/// From a height h it comes back to ε²·h.
TEST(RigidBody, BouncesAsItsRestitutionSays) {
  const auto device = openDevice("cpu");
  SimulatedScene scene(
      *device,
      bodyScene(R"("mass": 3, "position": [0, 1.1, 0], "restitution": 0.5)", R"("normal": [0, 1, 0])"),
      {"world.dt=0.001"});
  scene->reset();
  double highest = 0;
  bool bounced = false;
  const std::atomic<bool> stop = false;
  for (int k = 0; k < 20; ++k)
    scene->advanceFrame(stop, [&] {
      const BodyState state = scene.node<RigidBody>("body").state();
      bounced = bounced || state.velocity.y > 0;
      if (bounced) highest = std::max(highest, state.center.y - 0.1);
    });
  EXPECT_NEAR(highest, 0.25, 0.01);  // it comes 4.5 mm a step
}

TEST(RigidBody, SlidesWhereTheSlopeIsSteeperThanItsFriction) {
  const auto device = openDevice("cpu");
  constexpr double kFriction = 0.4;
  const auto slidOn = [&](double slope) {
    const double angle = std::atan(slope), degrees = angle * 180 / std::numbers::pi;
    // On a plane that rises along x; the box lies on it.
    const double height = 0.1 / std::cos(angle);
    SimulatedScene scene(
        *device,
        bodyScene(
            fmt::format(
                R"("mass": 3, "wall_friction": {}, "position": [0, {:.9f}, 0], "rotation": [0, 0, {:.9f}])",
                kFriction, height, degrees),
            fmt::format(R"("normal": [{:.9f}, {:.9f}, 0])", -std::sin(angle), std::cos(angle))));
    scene->reset();
    return length(stateAfter(scene, 20).center - Vec3d{0, height, 0});
  };
  EXPECT_LT(slidOn(0.99 * kFriction), 2e-3);
  const double slope = 1.05 * kFriction, angle = std::atan(slope);
  EXPECT_NEAR(slidOn(slope), 0.5 * 10 * (std::sin(angle) - kFriction * std::cos(angle)), 5e-3);
}

/// The error of a scene with that body.
std::string refusalOf(const std::string& body, const std::string& plane = "",
                      const std::vector<std::string>& overrides = {}) {
  const auto device = openDevice("cpu");
  return errorOf([&] {
           SimulatedScene scene(*device, bodyScene(body, plane), overrides);
           scene->reset();
         })
      .what();
}

TEST(RigidBody, RefusesWhatIsNoBody) {
  EXPECT_CONTAINS(refusalOf(""), "neither density nor mass is given");
  EXPECT_CONTAINS(refusalOf(R"("density": 500, "mass": 3)"), "both density and mass are given");
  EXPECT_CONTAINS(refusalOf(R"("mass": 0)"), "mass");
  EXPECT_CONTAINS(refusalOf(R"("density": -1)"), "density");
  EXPECT_CONTAINS(refusalOf(R"("mass": 3, "fixed": "xw")"), R"(found "xw" for axes)");
  EXPECT_CONTAINS(refusalOf(R"("mass": 3, "fixed_rotation": "xx")"), R"(found "xx" for axes)");
  EXPECT_CONTAINS(refusalOf(R"("mass": 3, "position": [0, 0.05, 0])", R"("normal": [0, 1, 0])"),
                  "the body starts 0.05 m deep within its walls");
}

/// A body whose mesh is given.
std::string refusalOf(TriangleMesh mesh) {
  const auto device = openDevice("cpu");
  Log log;
  Registry registry;
  SceneGraph graph;
  auto& body = static_cast<RigidBody&>(graph.add(std::make_unique<RigidBody>(), "body"));
  graph.add(std::make_unique<GivenMesh>(std::move(mesh)), "shape");
  graph.link(SceneGraph::parseLink("shape.surface -> body.mesh"));
  body.assignAll(object({{"density", 500.0}}), {"test", "", ""});
  return errorOf([&] { graph.reset({.device = *device, .log = log, .registry = registry}); }).what();
}

TEST(RigidBody, RefusesMeshesThatEncloseNothingCertain) {
  TriangleMesh open = boxMesh({0, 0, 0}, {1, 1, 1});
  open.triangles.pop_back();
  EXPECT_CONTAINS(refusalOf(open), "the mesh of 11 triangles from 'shape' has 3 open edges");
  TriangleMesh turned = boxMesh({0, 0, 0}, {1, 1, 1});
  turned.flip();
  EXPECT_CONTAINS(refusalOf(turned), "is inside out");
  EXPECT_CONTAINS(refusalOf(TriangleMesh{}), "is empty");
  EXPECT_CONTAINS(refusalOf(boxMesh({0, 0, 0}, {1, 1, 0})), "shape");
}

}  // namespace
}  // namespace weir::test
