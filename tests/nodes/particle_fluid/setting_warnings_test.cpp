// Warnings before a run: each appears with the number that says why, and a good setting is silent.
#include <gtest/gtest.h>

#include <cmath>

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
    "block": { "type": "BoxSampler", "params": { "arrangement": "lattice", "min": [0, 0, 0], "max": [0.2, 0.5, 0.2] } },
    "ball": { "type": "SphereSampler", "params": { "arrangement": "lattice", "center": [0.5, 0.5, 0.1], "radius": 0.081 } },
    "nozzle": { "type": "SquareEmitter",
                "params": { "position": [0.5, 0.9, 0.1], "width": 0.12, "height": 0.12, "speed": 2 } },
    "wall": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0.3, 0, 0], "max": [0.34, 0.2, 0.2] } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [1, 1, 0.2], "inverted": true } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.04, "rest_steps": 0, "bulk_modulus": 1e6 },
               "modules": { "solver": { "type": "SemiImplicitSolver" } } }
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
                   const std::vector<std::string>& good) {
  const std::vector<std::string> warnings = warningsWith(changes);
  ASSERT_EQ(warnings.size(), 1u) << changes.back() << (warnings.empty() ? "" : "\n" + warnings.back());
  for (const char* part : parts) EXPECT_CONTAINS(warnings[0], part);
  EXPECT_CONTAINS(warnings[0], "; better: ");
  changes.insert(changes.end(), good.begin(), good.end());
  const std::vector<std::string> silent = warningsWith(changes);
  EXPECT_TRUE(silent.empty()) << good.front() << "\n" << silent.front();
}

TEST(SettingWarnings, AGoodSceneIsSilent) {
  EXPECT_EQ(warningsWith({}), std::vector<std::string>{});
}

TEST(SettingWarnings, TheSolversNumber) {
  // c² = 1000 m²/s², so S = 1000·(0.01/0.04)²; 1 % · (62.5/3)^0.8 = 11 %.
  expectWarning({"nozzle.speed=1", "world.dt=0.01"},
                {"node 'water', module 'solver'", "S = (c·dt/d)² = 62.5", "about 11 % after 3 iterations",
                 " 9 iterations", "at most 0.006 s"},
                {"water.solver.iterations=9"});
  expectWarning({"nozzle.speed=1", "world.dt=0.01"}, {"S = "}, {"world.dt=0.005"});
  expectWarning({"nozzle.speed=1", "world.dt=0.01"}, {"S = "},
                {"water.solver.type=AcceleratedSolver", "water.solver.tolerance=0.01"});
}

TEST(SettingWarnings, TheSolversNumberIsThatOfTheFluidThatWasAskedFor) {
  // At 1.2d it is stiffened, and compressed no more for that.
  expectWarning({"nozzle.speed=1", "world.dt=0.01", "water.support_ratio=1.2"},
                {"S = (c·dt/d)² = 62.5", "about 11 % after 3 iterations"}, {"world.dt=0.001"});
}

/// Mean of max(λ − 1, 0) of a dam break with d = 4 cm and K = 1 MPa, over the time from 0.3 to 0.6 s.
double compressionOfDamBreak(double dt, int iterations) {
  CpuDevice device(2);
  constexpr const char* kDam = R"({
    "weir": 1, "world": { "frame_rate": 50, "duration": 0.6 },
    "nodes": {
      "block": { "type": "BoxSampler", "params": { "arrangement": "lattice", "min": [0, 0, 0], "max": [0.4, 0.4, 0.2] } },
      "tank": { "type": "StaticBoundary",
                "params": { "shape": "box", "min": [0, 0, 0], "max": [1, 1, 0.2], "inverted": true } },
      "water": { "type": "ParticleFluid", "params": { "spacing": 0.04 } } },
    "links": [ "block.particles -> water.initial", "tank.boundary -> water.boundaries" ] })";
  SimulatedScene scene(
      device, kDam,
      {"world.dt=" + std::to_string(dt), "water.solver.iterations=" + std::to_string(iterations)});
  scene->reset();
  const std::atomic<bool> never = false;
  double sum = 0;
  for (int frame = 1; frame <= 30; ++frame) {
    scene->advanceFrame(never);
    NodeReport report;
    scene.node<ParticleFluid>("water").report(report);
    if (frame > 15) sum += report.statistics.find("compression")->find("mean")->asDouble() / 15;
  }
  return sum;
}

TEST(SettingWarnings, CompressionOfADamBreakGrowsWithSOverIterations) {
  struct Case {
    double dt;
    int iterations;
  };
  for (const auto& [dt, iterations] : {Case{0.005, 3}, Case{0.01, 3}, Case{0.01, 6}, Case{0.01, 12}}) {
    const double number = 1000 * dt * dt / (0.04 * 0.04),
                 expected = 0.01 * std::pow(number / iterations, 0.8);
    const double compression = compressionOfDamBreak(dt, iterations);
    std::printf("dt %g ms, %d iterations: S = %.1f, mean compression %.2f %%, by the rule %.2f %%\n",
                1e3 * dt, iterations, number, 100 * compression, 100 * expected);
    EXPECT_GT(compression, 0.5 * expected);
    EXPECT_LT(compression, 2 * expected);
  }
}

TEST(SettingWarnings, AToleranceThatCannotBeMet) {
  // The fluid reaches from 0.02 m to 0.56: ρ0·g·h/(2·γ·K) = 9800·0.54/(2·0.75·1e6) = 0.0035, γ being that of
  // a support of 2 spacings.
  expectWarning({"water.solver.type=AcceleratedSolver", "water.solver.tolerance=0.001"},
                {"module 'solver'", "a tolerance of 0.001", "0.0035"},
                {"water.solver.type=AcceleratedSolver", "water.solver.tolerance=0.004"});
  // Between ρ0·g·h/(2·K) and this it cannot be met, either.
  expectWarning({"water.solver.type=AcceleratedSolver", "water.solver.tolerance=0.003"}, {"0.0035"},
                {"water.bulk_modulus=1.3e6"});
  expectWarning({"water.solver.type=AcceleratedSolver", "water.solver.tolerance=0.001"},
                {"bulk_modulus of at least"}, {"water.bulk_modulus=4e6"});
}

TEST(SettingWarnings, AFluidThatItsWeightCompresses) {
  expectWarning(
      {"water.bulk_modulus=1e5", "water.solver.type=AcceleratedSolver", "water.solver.tolerance=0.1"},
      {"node 'water'", "5.3e+03 Pa", "by 5.3 %", "bulk_modulus of at least 5.3e+05"},
      {"water.bulk_modulus=6e5"});
  expectWarning(
      {"water.bulk_modulus=1e5", "water.solver.type=AcceleratedSolver", "water.solver.tolerance=0.1"}, {"Pa"},
      {"world.gravity=[0, -1, 0]"});
}

TEST(SettingWarnings, AFluidTooStiffForItsNumbers) {
  // 5.3e3 Pa are 5.3e-8 of 1e11 Pa, half a rounding of 1; eight of them are 5.3e3/9.5e-7 = 5.6e9.
  const std::vector<std::string> changes{"water.solver.type=AcceleratedSolver",
                                         "water.solver.tolerance=0.001", "water.bulk_modulus=1e11"};
  expectWarning(changes, {"node 'water'", "5.3e-08", "single precision", "bulk_modulus of at most 5.6e+09"},
                {"water.bulk_modulus=5e9"});
  expectWarning(changes, {"rounding"}, {"world.gravity=[0, 0, 0]"});
}

TEST(SettingWarnings, SurfaceTensionOnTooSmallASupport) {
  CpuDevice device(1);
  std::string text = kGood;
  const std::string solver = R"("solver": { "type": "SemiImplicitSolver" })";
  text.insert(text.find(solver), R"("tension": { "type": "SurfaceTension", "after": "viscosity",
                                                "params": { "coefficient": 0.03 } }, )");
  const auto with = [&](const char* change) {
    SimulatedScene scene(device, text, {change});
    scene->reset();
    return scene.warnings();
  };
  const std::vector<std::string> warnings = with("water.support_ratio=1.5");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_CONTAINS(warnings[0],
                  "module 'tension': surface tension needs a support_ratio of at least 2; at 1.5");
  EXPECT_TRUE(with("water.support_ratio=2").empty());
}

TEST(SettingWarnings, AFluidThatNothingFills) {
  CpuDevice device(1);
  SimulatedScene scene(device, R"({ "weir": 1, "nodes": { "water": { "type": "ParticleFluid" } } })", {});
  scene->reset();
  ASSERT_EQ(scene.warnings().size(), 1u);
  EXPECT_CONTAINS(scene.warnings().front(), "node 'water': it stays empty");
}

TEST(SettingWarnings, ATooFastJet) {
  // 50 m/s · 1/1000 s are 5 cm.
  expectWarning({"nozzle.speed=50"},
                {"node 'nozzle'", "50 m/s", "1.25 spacings", "0.001 s", "at most 0.0004 s"},
                {"world.dt=0.0004"});
  expectWarning({"nozzle.speed=50"}, {"world.cfl"}, {"world.cfl=0.4"});
  expectWarning({"nozzle.speed={\"keyframes\": [[0, 1], [1, 50]]}"}, {"50 m/s"}, {"nozzle.stop=0.1"});
}

TEST(SettingWarnings, FastParticlesAtTheStart) {
  expectWarning({"ball.velocity=[30, 40, 0]"}, {"node 'water'", "50 m/s", "1.25 spacings"}, {"world.cfl=1"});
  expectWarning({"ball.velocity=[30, 40, 0]"}, {"at most 0.0004 s"}, {"world.dt=0.0004"});
}

TEST(SettingWarnings, TooFewStepsOfAFall) {
  // √(2·0.04/980) s = 9 ms; a frame of 0.1 s has 20 steps of 5 ms.
  const std::vector<std::string> changes{"world.dt=0.005", "world.gravity=[0, 0, -980]",
                                         "water.bulk_modulus=1e8", "water.solver.type=AcceleratedSolver",
                                         "water.solver.tolerance=0.1"};
  expectWarning(changes, {"node 'water'", "first spacing in 1.81 steps of 0.005 s", "at most 0.0023 s"},
                {"world.dt=0.002"});
  expectWarning(changes, {"world.cfl"}, {"world.cfl=0.5"});
}

TEST(SettingWarnings, WhatIsNarrowerThanAFewSpacings) {
  expectWarning({"nozzle.width=0.04", "nozzle.height=0.16"}, {"node 'nozzle'", "2 spacings wide", "0.027 m"},
                {"nozzle.width=0.12"});
  expectWarning({"block.max=[0.2, 0.08, 0.2]"}, {"node 'block'", "2 spacings thick", "0.027 m"},
                {"block.max=[0.2, 0.12, 0.2]"});
  expectWarning({"block.max=[0.2, 0.2, 0.2]", "wall.max=[0.31, 0.2, 0.2]"},
                {"node 'wall'", "0.25 spacings thick", "pass through", "0.04 m"},
                {"wall.max=[0.34, 0.2, 0.2]"});
  expectWarning({"tank.max=[1, 1, 0.08]"}, {"node 'tank'", "the room inside is 2 spacings thick"},
                {"tank.max=[1, 1, 0.12]"});
}

TEST(SettingWarnings, EveryShapeKnowsItsThickness) {
  const auto with = [](const std::string& parameters) {
    CpuDevice device(1);
    std::string text = R"({"weir": 1, "world": {"gravity": [0, 0, 0]}, "nodes": {
      "wall": {"type": "StaticBoundary", "params": PARAMETERS},
      "far": {"type": "BoxSampler", "params": {"arrangement": "lattice", "min": [9, 9, 9], "max": [9.2, 9.2, 9.2]}},
      "water": {"type": "ParticleFluid", "params": {"spacing": 0.04, "rest_steps": 0}}},
      "links": ["wall.boundary -> water.boundaries", "far.particles -> water.initial"]})";
    text.replace(text.find("PARAMETERS"), 10, parameters);
    SimulatedScene scene(device, text);
    scene->reset();
    return scene.warnings();
  };
  for (const char* thin :
       {R"({"shape": "sphere", "radius": 0.01})", R"({"shape": "capsule", "radius": 0.01, "height": 1})",
        R"({"shape": "cylinder", "radius": 1, "height": 0.02})",
        R"({"shape": "cylinder", "radius": 0.01, "height": 1})",
        R"({"shape": "cone", "radius": 1, "height": 0.02})"}) {
    const std::vector<std::string> warnings = with(thin);
    ASSERT_EQ(warnings.size(), 1u) << thin;
    EXPECT_CONTAINS(warnings[0], "0.5 spacings thick");
  }
  EXPECT_TRUE(with(R"({"shape": "sphere", "radius": 0.02})").empty());
  EXPECT_TRUE(with(R"({"shape": "plane"})").empty());
}

TEST(SettingWarnings, UnnormalizedStepsAtAnUnfitSpacing) {
  const auto with = [](double spacing) {
    CpuDevice device(1);
    std::string text = R"({"weir": 1, "world": {"dt": 0.001, "gravity": [0, 0, 0]}, "nodes": {
      "block": {"type": "BoxSampler", "params": { "arrangement": "lattice","max": [2, 2, 2], "min": [0, 0, 0]}},
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
  CpuDevice device(2);
  // The goblet's distances need not be fine here.
  const std::pair<const char*, std::vector<std::string>> scenes[] = {
      {"dam_break", {}}, {"jet_fills_goblet", {"glass.cell_size=0.02"}}};
  for (const auto& [name, changes] : scenes) {
    SimulatedScene scene(device, readFile(resourcesFolder() + "/scenes/" + name + ".json"), changes);
    scene->reset();
    for (const std::string& warning : scene.warnings())
      EXPECT_EQ(warning.find("; better"), warning.npos) << name << ": " << warning;
  }
}

}  // namespace
}  // namespace weir::test
