// Jets leave nozzles as they were laid, whatever the fluid's stiffness, and stop at walls.
#include "nodes/particle_fluid/inflow.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include "nodes/particle_fluid/particle_fluid.h"
#include "tests/support/devices.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

constexpr const char* kJet = R"({
  "weir": 1,
  "world": {"duration": 1, "dt": 0.001, "frame_rate": 20, "gravity": [0, 0, 0]},
  "nodes": {
    "nozzle": {"type": "SquareEmitter", "params": {"width": 0.06, "height": 0.06, "position": [0, 1, 0]}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.01}}
  },
  "links": ["nozzle.particles -> water.emitters"]
})";

struct Jet {
  std::vector<Vec3f> positions, velocities;
};

Jet jetOf(SimulatedScene& scene, int frames) {
  const std::atomic<bool> never = false;
  scene->reset();
  for (int frame = 0; frame < frames; ++frame) scene->advanceFrame(never);
  const ParticleSet& set = scene.node<ParticleFluid>("water").owned();
  return {set.positions().toHost(set.bound()), set.velocities().toHost(set.bound())};
}

TEST(Inflow, AJetWithoutForcesKeepsItsVelocityAndWidth) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    for (const char* arrangement : {"lattice", "relaxed"})
      for (const char* modulus : {"1e5", "1e6", "1e7"}) {
        SCOPED_TRACE(fmt::format("{} {} {}", name, arrangement, modulus));
        SimulatedScene scene(*device, kJet,
                             {fmt::format("nozzle.arrangement={}", arrangement),
                              fmt::format("water.bulk_modulus={}", modulus)});
        const Jet jet = jetOf(scene, 6);
        float sideways = 0, widest = 0, off = 0;
        for (std::size_t i = 0; i < jet.positions.size(); ++i) {
          const Vec3f &x = jet.positions[i], &v = jet.velocities[i];
          if (x.y < 0.75f) continue;  // the tip, whose layers nothing has held
          sideways = std::max(sideways, std::hypot(v.x, v.z));
          widest = std::max({widest, std::abs(x.x), std::abs(x.z)});
          off = std::max(off, std::abs(v.y + 1));
        }
        EXPECT_LT(sideways, 0.1f);  // of 1 m/s; 1 and more before
        EXPECT_LT(off, 0.1f);
        EXPECT_LT(widest, 0.035f);
      }
  }
}

TEST(Inflow, WhatWallsStopIsLetGo) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    Value scene = parseJson(kJet, "jet");
    scene["nodes"]["floor"] = parseJson(
        R"({"type": "StaticBoundary", "params": {"shape": "box", "min": [-1, 0.989, -1], "max": [1, 1.5, 1], "inverted": true}})",
        "floor");
    scene["links"].push("floor.boundary -> water.boundaries");
    SimulatedScene blocked(*device, writeJson(scene));
    const Jet jet = jetOf(blocked, 6);
    EXPECT_GT(jet.positions.size(), 300u);
    for (const Vec3f& x : jet.positions) EXPECT_GT(x.y, 0.989f) << name;
  }
}

}  // namespace
}  // namespace weir::test
