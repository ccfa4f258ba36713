// Warnings before a run: each appears with the number that says why, and a good setting is silent.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "framework/graph/setting_warning.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

/// Nothing in it is worth a warning.
constexpr const char* kGood = R"({
  "weir": 1,
  "world": { "dt": 0.001, "frame_rate": 10, "duration": 0.1 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.2, 0.5, 0.2] } },
    "ball": { "type": "SphereSampler", "params": { "center": [0.5, 0.5, 0.1], "radius": 0.081 } },
    "nozzle": { "type": "SquareEmitter",
                "params": { "position": [0.5, 0.9, 0.1], "width": 0.12, "height": 0.12, "speed": 2 } },
    "wall": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0.3, 0, 0], "max": [0.34, 0.2, 0.2] } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [1, 1, 0.2], "inverted": true } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.04 } }
  },
  "links": [ "block.particles -> water.initial", "ball.particles -> water.initial",
             "nozzle.particles -> water.emitters", "wall.boundary -> tank.boundaries",
             "tank.boundary -> water.boundaries" ]
})";

std::vector<std::string> warningsWith(const std::vector<std::string>& changes) {
  CpuDevice device(1);
  SimulatedScene scene(device, kGood, changes);
  scene->reset();
  return scene.warnings();
}

/// There is one warning, and it has these parts; with the good setting there is none.
void expectWarning(std::vector<std::string> changes, std::initializer_list<const char*> parts,
                   const std::string& good) {
  const std::vector<std::string> warnings = warningsWith(changes);
  ASSERT_EQ(warnings.size(), 1u) << changes.back() << (warnings.empty() ? "" : "\n" + warnings.back());
  for (const char* part : parts) EXPECT_CONTAINS(warnings[0], part);
  EXPECT_CONTAINS(warnings[0], "; better: ");
  changes.push_back(good);
  const std::vector<std::string> silent = warningsWith(changes);
  EXPECT_TRUE(silent.empty()) << good << "\n" << silent.front();
}

TEST(SettingWarnings, AGoodSceneIsSilent) {
  EXPECT_EQ(warningsWith({}), std::vector<std::string>{});
}

TEST(SettingWarnings, TheSolversNumber) {
  // c² = 1000 m²/s², so S = 1000·(0.01/0.04)²; 0.8 % · 62.5/3 = 17 %.
  expectWarning({"nozzle.speed=1", "world.dt=0.01"},
                {"node 'water', module 'solver'", "S = (c·dt/d)² = 62.5", "about 17 % after 3 iterations",
                 "10 iterations", "at most 0.0055 s"},
                "water.solver.iterations=10");
  expectWarning({"nozzle.speed=1", "world.dt=0.01"}, {"S = "}, "world.dt=0.005");
  expectWarning({"nozzle.speed=1", "world.dt=0.01"}, {"S = "}, "water.bulk_modulus=250000");
  expectWarning({"nozzle.speed=1", "world.dt=0.01"}, {"S = "}, "water.solver.tolerance=0.01");
  expectWarning({"nozzle.speed=1", "world.dt=0.01"}, {"S = "}, "water.solver.enabled=false");
}

TEST(SettingWarnings, AToleranceThatCannotBeMet) {
  // The fluid reaches from 0.02 m to 0.56 or so: ρ0·g·h/(2·K) = 9800·0.54/2e6 = 0.0027.
  expectWarning({"water.solver.tolerance=0.001"}, {"module 'solver'", "a tolerance of 0.001", "0.0027"},
                "water.solver.tolerance=0.003");
  expectWarning({"water.solver.tolerance=0.001"}, {"bulk_modulus of at least"}, "water.bulk_modulus=4e6");
}

TEST(SettingWarnings, AFluidThatItsWeightCompresses) {
  expectWarning({"water.bulk_modulus=1e5", "water.solver.tolerance=0.1"},
                {"node 'water'", "5.3e+03 Pa", "by 5.3 %", "bulk_modulus of at least 5.3e+05"},
                "water.bulk_modulus=6e5");
  expectWarning({"water.bulk_modulus=1e5", "water.solver.tolerance=0.1"}, {"Pa"}, "world.gravity=[0, -1, 0]");
}

TEST(SettingWarnings, ATooFastJet) {
  // 50 m/s · 1/1000 s are 5 cm.
  expectWarning({"nozzle.speed=50"},
                {"node 'nozzle'", "50 m/s", "1.25 spacings", "0.001 s", "at most 0.0004 s"},
                "world.dt=0.0004");
  expectWarning({"nozzle.speed=50"}, {"world.cfl"}, "world.cfl=0.4");
  expectWarning({"nozzle.speed={\"keyframes\": [[0, 1], [1, 50]]}"}, {"50 m/s"}, "nozzle.stop=0.1");
}

TEST(SettingWarnings, FastParticlesAtTheStart) {
  expectWarning({"ball.velocity=[30, 40, 0]"}, {"node 'water'", "50 m/s", "1.25 spacings"}, "world.cfl=1");
  expectWarning({"ball.velocity=[30, 40, 0]"}, {"at most 0.0004 s"}, "world.dt=0.0004");
}

TEST(SettingWarnings, TooFewStepsOfAFall) {
  // √(2·0.04/980) s = 9 ms; a frame of 0.1 s has 20 steps of 5 ms.
  const std::vector<std::string> changes{"world.dt=0.005", "world.gravity=[0, 0, -980]",
                                         "water.bulk_modulus=1e8", "water.solver.tolerance=0.1"};
  expectWarning(changes, {"node 'water'", "first spacing in 1.81 steps of 0.005 s", "at most 0.0023 s"},
                "world.dt=0.002");
  expectWarning(changes, {"world.cfl"}, "world.cfl=0.5");
}

TEST(SettingWarnings, WhatIsNarrowerThanAFewSpacings) {
  expectWarning({"nozzle.width=0.04", "nozzle.height=0.16"}, {"node 'nozzle'", "2 spacings wide", "0.027 m"},
                "nozzle.width=0.12");
  expectWarning({"block.max=[0.2, 0.08, 0.2]"}, {"node 'block'", "2 spacings thick", "0.027 m"},
                "block.max=[0.2, 0.12, 0.2]");
  expectWarning({"block.max=[0.2, 0.2, 0.2]", "wall.max=[0.31, 0.2, 0.2]"},
                {"node 'wall'", "0.25 spacings thick", "pass through", "0.04 m"},
                "wall.max=[0.34, 0.2, 0.2]");
  expectWarning({"tank.max=[1, 1, 0.08]"}, {"node 'tank'", "the room inside is 2 spacings thick"},
                "tank.max=[1, 1, 0.12]");
}

TEST(SettingWarnings, OtherShapes) {
  const std::vector<std::string> silent = warningsWith({"tank.shape=plane"});
  ASSERT_TRUE(silent.empty()) << silent.front();
}

TEST(SettingWarnings, UnnormalizedStepsAtAnUnfitSpacing) {
  const auto with = [](double spacing) {
    CpuDevice device(1);
    std::string text = R"({"weir": 1, "world": {"dt": 0.001, "gravity": [0, 0, 0]}, "nodes": {
      "block": {"type": "BoxSampler", "params": {"max": [2, 2, 2], "min": [0, 0, 0]}},
      "water": {"type": "ParticleFluid", "params": {"spacing": SPACING}, "modules":
                {"solver": {"type": "Pbf", "params": {"form": "unnormalized"}}}}},
      "links": ["block.particles -> water.initial"]})";
    text.replace(text.find("SPACING"), 7, std::to_string(spacing));
    SimulatedScene scene(device, text, {"block.max=[0.3, 0.3, 0.3]"});
    scene->reset();
    return scene.warnings();
  };
  // 10·ρ0·d³ is 10 at 10 cm, 0.27 at 3 cm, and 0.01 at 1 cm.
  auto coarse = with(0.1);
  ASSERT_EQ(coarse.size(), 1u);
  EXPECT_CONTAINS(coarse[0], "10 times those of the textbook form, so they overshoot");
  EXPECT_TRUE(with(0.03).empty());
  const auto fine = with(0.01);
  ASSERT_EQ(fine.size(), 1u);
  EXPECT_CONTAINS(fine[0], "0.01 times those of the textbook form, so they hardly act");
}

TEST(SettingWarnings, TheScenesOfTheProjectAreSilent) {
  for (const auto& entry : std::filesystem::directory_iterator(resourcesFolder() + "/scenes")) {
    if (entry.path().extension() != ".json" || entry.path().stem() == "mesh_in_tank")
      continue;  // needs a mesh
    CpuDevice device(2);
    SimulatedScene scene(device, readFile(entry.path()));
    scene->reset();
    for (const std::string& warning : scene.warnings())
      EXPECT_EQ(warning.find("; better"), warning.npos) << warning;
  }
}

}  // namespace
}  // namespace weir::test
