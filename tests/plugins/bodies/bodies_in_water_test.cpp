// Bodies that collide in water: few and a hundred, with the same bits.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdio>

#include "nodes/rigid_body/rigid_body.h"
#include "tests/plugins/bodies/bullet_registry.h"
#include "tests/support/devices.h"
#include "tests/support/resumed_scene.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

/// A light box on water, and one that falls onto it and slides off.
std::string bathed() {
  return R"({"weir": 1, "world": {"gravity": [0, -9.8, 0], "dt": 0.004, "frame_rate": 25, "duration": 5},
    "nodes": {
      "block": {"type": "BoxSampler", "params": {"min": [-0.1, 0, -0.1], "max": [0.1, 0.12, 0.1]}},
      "tank": {"type": "StaticBoundary",
               "params": {"shape": "box", "inverted": true, "min": [-0.1, 0, -0.1], "max": [0.1, 2, 0.1]}},
      "mesh": {"type": "BoxMesh", "params": {"min": [-0.05, -0.03, -0.05], "max": [0.05, 0.03, 0.05]}},
      "b0": {"type": "RigidBody", "params": {"density": 300, "position": [0, 0.16, 0]}},
      "b1": {"type": "RigidBody", "params": {"density": 300, "position": [0.01, 0.26, 0], "rotation": [5, 10, 0]}},
      "contacts": {"type": "BodyContacts"},
      "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "rest_steps": 20}}},
    "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
              "mesh.surface -> b0.mesh", "mesh.surface -> b1.mesh", "water.fluid -> b0.fluid",
              "water.fluid -> b1.fluid", "tank.boundary -> b0.walls", "tank.boundary -> b1.walls",
              "b0.body -> contacts.bodies", "b1.body -> contacts.bodies"]})";
}

TEST(BodiesInWater, BoxesInWaterStayApartWithTheSameBitsForAnyNumberOfThreads) {
  const auto one = openDevice("cpu", 1), three = openDevice("cpu", 3);
  SimulatedScene first(*one, bathed(), {}, addBullet), second(*three, bathed(), {}, addBullet);
  const std::atomic<bool> stop = false;
  for (SimulatedScene* scene : {&first, &second}) {
    (*scene)->reset();
    for (int k = 0; k < 20; ++k) (*scene)->advanceFrame(stop);
  }
  const BodyState below = first.node<RigidBody>("b0").state(), above = first.node<RigidBody>("b1").state();
  EXPECT_EQ(above.center, second.node<RigidBody>("b1").state().center);
  EXPECT_EQ(above.velocity, second.node<RigidBody>("b1").state().velocity);
  std::printf("boxes at %.4f and %.4f m\n", above.center.y, below.center.y);
  EXPECT_GT(length(above.center - below.center), 0.055);
  EXPECT_LT(above.center.y, 0.25);
  EXPECT_GT(below.center.y, 0.05);
}

/// A hundred boxes fall onto water and each other.
std::string heap(int bodies) {
  return fmt::format(R"scene({{"weir": 1, "let": {{"bodies": {}}},
    "world": {{"gravity": [0, -9.8, 0], "dt": 0.002, "frame_rate": 50, "duration": 5}},
    "nodes": {{
      "block": {{"type": "BoxSampler", "params": {{"min": [-0.2, 0, -0.2], "max": [0.2, 0.12, 0.2]}}}},
      "tank": {{"type": "StaticBoundary", "params": {{"shape": "box", "inverted": true,
                                                      "min": [-0.2, 0, -0.2], "max": [0.2, 2, 0.2]}}}},
      "crate": {{"type": "BoxMesh", "params": {{"min": [-0.02, -0.02, -0.02], "max": [0.02, 0.02, 0.02]}}}},
      "contacts": {{"type": "BodyContacts"}},
      "body_{{k}}": {{"repeat": "=bodies", "as": "k", "node": {{"type": "RigidBody", "params": {{
        "density": 500, "velocity": [0, -1, 0], "rotation": [0, "=7*k", 0],
        "position": ["=0.06*(k-5*floor(k/5)-2)", "=0.15+0.045*floor(k/25)",
                     "=0.06*(floor(k/5)-5*floor(k/25)-2)"]}}}}}},
      "water": {{"type": "ParticleFluid", "params": {{"spacing": 0.03, "rest_steps": 0}},
                 "modules": {{"solver": {{"type": "SemiImplicitSolver", "params": {{"iterations": 10}}}}}}}}}},
    "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
      {{"repeat": "=bodies", "as": "k", "item": "crate.surface -> body_{{k}}.mesh"}},
      {{"repeat": "=bodies", "as": "k", "item": "water.fluid -> body_{{k}}.fluid"}},
      {{"repeat": "=bodies", "as": "k", "item": "tank.boundary -> body_{{k}}.walls"}},
      {{"repeat": "=bodies", "as": "k", "item": "body_{{k}}.body -> contacts.bodies"}}]}})scene",
                     bodies);
}

BodyState stateIn(SimulatedScene& scene, int k) {
  return scene.node<RigidBody>(fmt::format("body_{}", k).c_str()).state();
}

TEST(BodiesInWater, AHundredBoxesInWaterHaveTheSameBitsForAnyNumberOfThreads) {
  constexpr int kCount = 100;
  const auto one = openDevice("cpu", 1), four = openDevice("cpu", 4);
  SimulatedScene first(*one, heap(kCount), {}, addBullet), second(*four, heap(kCount), {}, addBullet);
  const std::atomic<bool> stop = false;
  for (SimulatedScene* scene : {&first, &second}) {
    (*scene)->reset();
    for (int k = 0; k < 3; ++k) (*scene)->advanceFrame(stop);
  }
  double nearest = 1;
  for (int k = 0; k < kCount; ++k) {
    const BodyState a = stateIn(first, k), b = stateIn(second, k);
    EXPECT_EQ(a.center, b.center) << k;
    EXPECT_EQ(a.rotation, b.rotation) << k;
    EXPECT_EQ(a.velocity, b.velocity) << k;
    EXPECT_EQ(a.spin, b.spin) << k;
    for (int other = 0; other < k; ++other)
      nearest = std::min(nearest, length(a.center - stateIn(first, other).center));
  }
  std::printf("the nearest boxes of a side of 0.04 m are %.4f m apart\n", nearest);
  EXPECT_GT(nearest, 0.039);
}

TEST(BodiesInWater, AHundredBoxesInWaterGoOnBitByBit) {
  EXPECT_EQ(resumedSceneDifferences(heap(100), {.savedAt = 2, .comparedFor = 1}, {}, addBullet),
            std::vector<std::string>{});
}

/// Blocking readbacks of a step within a frame.
std::uint64_t readbacksWith(Device& device, int bodies) {
  SimulatedScene scene(device, heap(bodies), {}, addBullet);
  scene->reset();
  std::vector<std::uint64_t> readbacks;
  const std::atomic<bool> stop = false;
  scene->advanceFrame(stop, [&] { readbacks.push_back(device.blockingReadbacks()); });
  return readbacks[4] - readbacks[3];
}

TEST(BodiesInWater, StepsWaitForTheHostAsOftenWhateverTheNumberOfBodies) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    EXPECT_EQ(readbacksWith(*device, 40), readbacksWith(*device, 20)) << name;
  }
}

}  // namespace
}  // namespace weir::test
