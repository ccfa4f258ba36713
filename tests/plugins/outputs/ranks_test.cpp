// `weir run --ranks N`: the same files for any number of ranks, and a clear word where a scene cannot.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "framework/scene/scene_file.h"
#include "tests/plugins/outputs/ranks_run.h"
#include "tests/plugins/outputs/written_run.h"
#include "tests/support/child_process.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/find_program.h"

namespace weir::test {
namespace {

/// A node that has not the role.
constexpr const char* kTracers = R"({
  "weir": 1,
  "nodes": {
    "block": { "type": "BoxSampler" },
    "points": { "type": "VortexTracers" }
  },
  "links": ["block.particles -> points.initial"]
})";

std::string pluginOfTracers() {
  return buildFolder() + "/lib/weir/test_plugins/weir_tracers.so";
}

constexpr const char* kFewIterations = "water.solver.type=SemiImplicitSolver";
const std::vector<std::string> kFew{"2", "4"};

TEST_F(RanksTest, ADamBreakIsTheSameForAnyNumberOfRanks) {
  rest_.clear();
  expectSameForAnyNumber({kCoarse}, {"2", "3", "8"});
}

TEST_F(RanksTest, SoIsOneWithVaryingStepsFrictionAndImplicitViscosity) {
  expectSameForAnyNumber({kCoarse, "world.cfl=0.4", "world.dt=0.004", "tank.friction=0.2",
                          "tank.restitution=0.3", "water.viscosity.form=implicit", kFewIterations,
                          "water.solver.step_length=particle", "water.pressure=true"});
}

TEST_F(RanksTest, SoIsOneWhoseSolverSearchesALengthForAllParticlesAndRecordsTheObjective) {
  expectSameForAnyNumber({"water.spacing=0.08", kFewIterations, "water.solver.step_length=global",
                          "water.solver.record_objective=true"},
                         kFew);
}

/// Water that is thrown at a wall with a rough surface, by steps in which it flies further than a spacing.
constexpr const char* kThrown = R"({
  "weir": 1,
  "world": { "dt": 0.01, "frame_rate": 30 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.4, 0.4, 0.2], "velocity": [6, 0, 0] } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [1.2, 1, 0.2], "inverted": true,
                          "friction": 0.2, "restitution": 0.2 } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.05, "support_ratio": 1.5, "rest_steps": 0 },
               "modules": { "solver": { "type": "AcceleratedSolver", "params": { "max_iterations": 20 } } } }
  },
  "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries"]
})";

TEST_F(RanksTest, SoIsOneThatIsSolvedToAToleranceByConjugateGradientsInStages) {
  rest_.clear();
  scene_ = folder_.write("thrown.json", kThrown);
  expectSameForAnyNumber({"water.solver.record_objective=true"}, kFew);
  const Value statistics = parseJson(readFile(folder_ / "4/stats.json"), "stats.json");
  const Value& water = *statistics.find("nodes")->find("water");
  EXPECT_GT(water.find("solver_stages")->find("max")->asInt(), 1);
  EXPECT_GT(water.find("solver_iterations")->find("max")->asInt(), 3);
}

TEST_F(RanksTest, SoIsOneWithMomentumAndALengthOfStepsOfAllParticlesTogether) {
  rest_.clear();
  scene_ = folder_.write("thrown.json", kThrown);
  expectSameForAnyNumber({"water.solver.acceleration=nesterov", "water.solver.step_length=global"}, kFew);
}

TEST_F(RanksTest, SoIsOneOfPositionBasedFluid) {
  rest_.clear();
  scene_ = folder_.write(
      "thrown.json",
      std::regex_replace(kThrown, std::regex("\"AcceleratedSolver\".*\\} \\} \\} \\}"), "\"Pbf\" } } }"));
  expectSameForAnyNumber({"world.dt=0.002", "water.solver.record_objective=true"}, kFew);
}

TEST_F(RanksTest, SoIsOneByTwoProjections) {
  rest_.clear();
  scene_ = folder_.write(
      "thrown.json",
      std::regex_replace(kThrown,
                         std::regex("\"support_ratio\": 1.5(.*\n.*)\"AcceleratedSolver\".*\\} \\} \\} \\}"),
                         "\"support_ratio\": 2$1\"TwoProjections\" } } }"));
  expectSameForAnyNumber({"world.dt=0.004"}, kFew);
  const Value statistics = parseJson(readFile(folder_ / "4/stats.json"), "stats.json");
  EXPECT_GT(statistics.find("nodes")->find("water")->find("projection_iterations")->asDouble(), 3);
}

/// Honey in a tank that reports forces, with a gauge of its flow.
constexpr const char* kHoney = R"({
  "weir": 1,
  "world": { "dt": 0.004, "frame_rate": 30 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.4, 0.3, 0.2] } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [1, 1, 0.2], "inverted": true,
                          "friction": 0.1, "report_forces": true,
                          "parts": [{ "name": "left", "min": [-1, -1, -1], "max": [0.2, 1, 1] }] } },
    "plane": { "type": "Gauge",
               "params": { "shape": "plane", "position": [0.4, 0.2, 0.1], "normal": [1, 0, 0] } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.04 },
               "modules": { "thick": { "type": "ViscositySolver", "after": "walls",
                                       "params": { "viscosity": 2, "tolerance": 1e-4 } } } }
  },
  "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
            "water.fluid -> plane.particles"]
})";

TEST_F(RanksTest, SoIsOneOfHoneyWithAGaugeOfTheFlowAndForcesOnTheTank) {
  scene_ = folder_.write("honey.json", kHoney);
  expectSameForAnyNumber({}, kFew);
  const Value statistics = parseJson(readFile(folder_ / "4/stats.json"), "stats.json");
  const Value& nodes = *statistics.find("nodes");
  EXPECT_GT(nodes.find("water")->find("viscosity_iterations_mean")->asDouble(), 1);
  EXPECT_GT(nodes.find("plane")->find("volume")->asDouble(), 0);
  // The floor carries the weight.
  const double weight = 1000 * 0.4 * 0.3 * 0.2 * 9.81;
  EXPECT_NEAR(nodes.find("tank")->find("force")->asArray()[1].asDouble(), -weight, 0.2 * weight);
  // What stands at the left carries a part of it.
  const double left = nodes.find("tank")->find("parts")->find("left")->find("force")->asArray()[1].asDouble();
  EXPECT_LT(left, -0.2 * weight);
  EXPECT_GT(left, -0.8 * weight);
}

TEST_F(RanksTest, SoIsOneInAMeshWithAStirrerAnEmitterAndADrain) {
  scene_ = folder_.write("stirred.json", kStateful);
  expectSameForAnyNumber({}, kFew);
  const Value statistics = parseJson(readFile(folder_ / "4/stats.json"), "stats.json");
  const Value& solid = statistics.find("nodes")->find("walls")->find("solids")->asArray().front();
  EXPECT_LT(solid.find("force")->asArray()[1].asDouble(), 0);
}

/// A thin wall between two heights of water, on one of which a body floats.
constexpr const char* kDivided = R"({
  "weir": 1,
  "world": { "dt": 0.004, "frame_rate": 50 },
  "nodes": {
    "left": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.29, 0.24, 0.24] } },
    "right": { "type": "BoxSampler", "params": { "min": [0.31, 0, 0], "max": [0.6, 0.12, 0.24] } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [0.6, 1, 0.24], "inverted": true } },
    "board": { "type": "BoxMesh", "params": { "min": [0.295, 0.04, -0.1], "max": [0.305, 0.5, 0.34] } },
    "wall": { "type": "SemiAnalyticalSFI" },
    "crate": { "type": "BoxMesh", "params": { "min": [-0.05, -0.05, -0.05], "max": [0.05, 0.05, 0.05] } },
    "body": { "type": "RigidBody", "params": { "density": 400, "position": [0.15, 0.28, 0.12] } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.04 } }
  },
  "links": ["left.particles -> water.initial", "right.particles -> water.initial",
            "tank.boundary -> water.boundaries", "board.surface -> wall.solids", "water.fluid -> wall.fluid",
            "crate.surface -> body.mesh", "water.fluid -> body.fluid", "tank.boundary -> body.walls"]
})";

TEST_F(RanksTest, SoIsOneThatAThinWallDividesAndABodyFloatsOn) {
  duration_ = "0.2";
  scene_ = folder_.write("divided.json", kDivided);
  expectSameForAnyNumber({}, kFew);
  const Value statistics = parseJson(readFile(folder_ / "4/stats.json"), "stats.json");
  EXPECT_GT(statistics.find("nodes")->find("body")->find("force")->asArray()[1].asDouble(), 0);
}

/// Twenty cubes, so many that they are looked up in a grid and summed by lists.
constexpr const char* kManyBodies = R"scene({
  "weir": 1,
  "let": { "bodies": 20 },
  "world": { "dt": 0.004, "frame_rate": 100 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [-0.24, 0, -0.12], "max": [0.24, 0.09, 0.12] } },
    "tank": { "type": "StaticBoundary", "params": { "shape": "box", "min": [-0.24, 0, -0.12],
                                                    "max": [0.24, 2, 0.12], "inverted": true } },
    "crate": { "type": "BoxMesh", "params": { "min": [-0.02, -0.02, -0.02], "max": [0.02, 0.02, 0.02] } },
    "body_{k}": { "repeat": "=bodies", "as": "k", "node": { "type": "RigidBody", "params": {
      "density": 400, "rotation": [10, "=0.5*k", 5],
      "position": ["=-0.18+0.09*(k-5*floor(k/5))", 0.1, "=-0.09+0.06*floor(k/5)"] } } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.03 },
               "modules": { "solver": { "type": "SemiImplicitSolver", "params": { "iterations": 10 } },
                            "viscosity": { "params": { "rate": 75 } } } }
  },
  "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
            { "repeat": "=bodies", "as": "k", "item": "crate.surface -> body_{k}.mesh" },
            { "repeat": "=bodies", "as": "k", "item": "water.fluid -> body_{k}.fluid" },
            { "repeat": "=bodies", "as": "k", "item": "tank.boundary -> body_{k}.walls" }]
})scene";

TEST_F(RanksTest, SoIsOneOnWhichManyBodiesFloat) {
  duration_ = "0.1";
  scene_ = folder_.write("many.json", kManyBodies);
  expectSameForAnyNumber({}, {"3"});
  const Value statistics = parseJson(readFile(folder_ / "3/stats.json"), "stats.json");
  EXPECT_GT(statistics.find("nodes")->find("body_7")->find("force")->asArray()[1].asDouble(), 0);
}

/// Two boxes, one of which falls onto the other, and a paddle that a motor turns.
constexpr const char* kColliding = R"({
  "weir": 1,
  "world": { "dt": 0.004, "frame_rate": 50 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [-0.3, 0, -0.1], "max": [0.3, 0.12, 0.1] } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [-0.3, 0, -0.1], "max": [0.3, 1, 0.1], "inverted": true } },
    "crate": { "type": "BoxMesh", "params": { "min": [-0.05, -0.03, -0.05], "max": [0.05, 0.03, 0.05] } },
    "blade": { "type": "BoxMesh", "params": { "min": [-0.1, -0.02, -0.06], "max": [0.1, 0.02, 0.06] } },
    "low": { "type": "RigidBody", "params": { "density": 400, "position": [-0.15, 0.18, 0] } },
    "high": { "type": "RigidBody", "params": { "density": 600, "position": [-0.12, 0.26, 0], "rotation": [0, 20, 5] } },
    "paddle": { "type": "RigidBody", "params": { "density": 700, "position": [0.15, 0.14, 0] } },
    "axle": { "type": "Joint", "params": { "kind": "hinge", "anchor": [0.15, 0.14, 0], "axis": [0, 0, 1],
                                           "motor": true, "speed": 6 } },
    "contacts": { "type": "BodyContacts" },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.03 },
               "modules": { "solver": { "type": "SemiImplicitSolver", "params": { "iterations": 10 } } } }
  },
  "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
            "crate.surface -> low.mesh", "crate.surface -> high.mesh", "blade.surface -> paddle.mesh",
            "water.fluid -> low.fluid", "water.fluid -> high.fluid", "water.fluid -> paddle.fluid",
            "tank.boundary -> low.walls", "tank.boundary -> high.walls",
            "low.body -> contacts.bodies", "high.body -> contacts.bodies", "paddle.body -> contacts.bodies",
            "paddle.body -> axle.body", "axle.joint -> contacts.joints"]
})";

TEST_F(RanksTest, SoIsOneInWhichBodiesCollideAndAreHeldByJoints) {
  if (!std::filesystem::exists(buildFolder() + "/lib/weir/plugins/weir_bodies.so"))
    GTEST_SKIP() << "there was no Bullet when this was built";
  duration_ = "0.24";
  scene_ = folder_.write("colliding.json", kColliding);
  expectSameForAnyNumber({}, {"3"});
  const Value statistics = parseJson(readFile(folder_ / "3/stats.json"), "stats.json");
  EXPECT_GT(statistics.find("nodes")->find("contacts")->find("held")->asInt(), 0);
}

TEST_F(RanksTest, SoIsOneWithSurfaceTensionEddiesAndDrag) {
  const std::string scene = folder_.write("drop.json", R"({
    "weir": 1,
    "world": { "gravity": [0, -2, 0], "dt": 0.002, "frame_rate": 30, "duration": 0.3 },
    "nodes": {
      "drop": { "type": "SphereSampler", "params": { "center": [0, 0.3, 0], "radius": 0.2, "velocity": [1, 0, 0] } },
      "floor": { "type": "StaticBoundary", "params": { "shape": "plane" } },
      "water": { "type": "ParticleFluid", "params": { "spacing": 0.04, "rest_steps": 20 },
                 "modules": { "tension": { "type": "SurfaceTension", "after": "viscosity",
                                           "params": { "coefficient": 0.1, "air_pressure": 1 } },
                              "eddies": { "type": "VorticityConfinement", "after": "viscosity" },
                              "drag": { "type": "Drag", "after": "tension" } } }
    },
    "links": ["drop.particles -> water.initial", "floor.boundary -> water.boundaries"]
  })");
  for (const std::string ranks : {"1", "2", "4"}) {
    const ChildResult result =
        runWeir({"run", scene, "--quiet", "--ranks", ranks, "--export", folder_ / (ranks + ".vtkhdf")});
    ASSERT_EQ(result.code, 0) << result.err;
    expectSameExports(folder_ / "1.vtkhdf", folder_ / (ranks + ".vtkhdf"));
  }
}

TEST_F(RanksTest, SoIsADropUnderItsTension) {
  const std::string scene = folder_.write("free.json", R"({
    "weir": 1,
    "world": { "gravity": [0, 0, 0], "dt": 0.002, "frame_rate": 30, "duration": 0.3 },
    "nodes": {
      "drop": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.5, 0.25, 0.25] } },
      "water": { "type": "ParticleFluid", "params": { "spacing": 0.03, "rest_steps": 20 },
                 "modules": { "tension": { "type": "CapillaryForce", "after": "viscosity",
                                           "params": { "tension": 10, "air_pressure": 1 } } } }
    },
    "links": ["drop.particles -> water.initial"]
  })");
  for (const std::string ranks : {"1", "2", "3"}) {
    const ChildResult result =
        runWeir({"run", scene, "--quiet", "--ranks", ranks, "--export", folder_ / (ranks + ".vtkhdf")});
    ASSERT_EQ(result.code, 0) << result.err;
    expectSameExports(folder_ / "1.vtkhdf", folder_ / (ranks + ".vtkhdf"));
  }
}

TEST_F(RanksTest, SoIsOneWhoseParticlesLeaveTheDomain) {
  expectSameForAnyNumber({kCoarse, "water.domain_max=[0.7, 5, 5]", "water.rest_steps=0"});
}

TEST_F(RanksTest, SoIsAJetIntoATankWithAHole) {
  const std::string scene = folder_.write("jet.json", kJet);
  const auto nodesOf = [&](const std::string& ranks) {
    const ChildResult result =
        runWeir({"run", scene, "--quiet", "--ranks", ranks, "--stats", folder_ / (ranks + ".json"),
                 "--export", folder_ / (ranks + ".vtkhdf")});
    EXPECT_EQ(result.code, 0) << result.err;
    return *parseJson(readFile(folder_ / (ranks + ".json")), "stats.json").find("nodes");
  };
  const Value one = nodesOf("1");
  EXPECT_GT(one.find("hole")->find("particles_removed")->asInt(), 0);
  EXPECT_GT(one.find("water")->find("particles")->asInt(), 500);
  for (const std::string ranks : {"2", "4"}) {
    EXPECT_EQ(writeJson(nodesOf(ranks)), writeJson(one)) << ranks << " ranks";
    expectSameExports(folder_ / "1.vtkhdf", folder_ / (ranks + ".vtkhdf"));
  }
}

TEST_F(RanksTest, RanksMayHaveNoParticles) {
  // Four cells along x, where the block is a bit longer, so at least half of the ranks have none.
  const std::vector<std::string> small{"water.spacing=0.05", "block.max=[0.2, 0.15, 0.15]"};
  const Outcome one = run("one", small, {"--ranks", "1"}), many = run("many", small, {"--ranks", "16"});
  ASSERT_EQ(one.result.code, 0) << one.result.err;
  ASSERT_EQ(many.result.code, 0) << many.result.err;
  EXPECT_TRUE(many.files == one.files);
}

TEST_F(RanksTest, ProcessesOfMpiWriteTheSameAsThreads) {
  if (!hasMpi()) GTEST_SKIP() << "there is no MPI, or it was not there when this was built";
  const Outcome threads = run("threads", {kCoarse}, {"--ranks", "2"}),
                processes = run("mpi", {kCoarse}, {}, 3);
  ASSERT_EQ(threads.result.code, 0) << threads.result.err;
  ASSERT_EQ(processes.result.code, 0) << processes.result.err;
  EXPECT_TRUE(processes.files == threads.files);
  EXPECT_EQ(writeJson(fluidOf(processes)), writeJson(fluidOf(threads)));
}

TEST_F(RanksTest, WhatProcessesOfMpiCannotDoIsSaidOnceByTheFirst) {
  if (!hasMpi()) GTEST_SKIP() << "there is no MPI, or it was not there when this was built";
  scene_ = folder_.write("tracers.json", kTracers);
  rest_.clear();
  const Outcome refused = run("refused", {}, {"--plugin", pluginOfTracers()}, 3);
  EXPECT_EQ(refused.result.code, 3);
  const std::string words = "a VortexTracers cannot run on several ranks yet";
  EXPECT_CONTAINS(refused.result.err, words);
  EXPECT_EQ(refused.result.err.find(words), refused.result.err.rfind(words));
}

TEST_F(RanksTest, TheyAreAsGoodAsARunWithoutThem) {
  // The order of sums differs, so the two part in time; the water does not.
  const Outcome with = run("with", {kCoarse}, {"--ranks", "3"}),
                without = run("without", {kCoarse}, {"--device", "cpu"});
  ASSERT_EQ(with.result.code, 0) << with.result.err;
  ASSERT_EQ(without.result.code, 0) << without.result.err;
  const auto number = [](const Outcome& run, const char* name) {
    return fluidOf(run).find(name)->asDouble();
  };
  EXPECT_EQ(number(with, "particles"), number(without, "particles"));
  EXPECT_NEAR(number(with, "kinetic_energy") / number(without, "kinetic_energy"), 1, 0.02);
  EXPECT_NEAR(number(with, "potential_energy") / number(without, "potential_energy"), 1, 0.02);
}

TEST_F(RanksTest, WhatCannotRunOnThemIsRefusedWithWhatToDo) {
  const auto errorOf = [&](const std::vector<std::string>& changes, const std::vector<std::string>& more) {
    std::vector<std::string> all{"--ranks", "2"};
    all.insert(all.end(), more.begin(), more.end());
    const Outcome refused = run("refused", changes, all);
    EXPECT_NE(refused.result.code, 0);
    EXPECT_CONTAINS(refused.result.err, "--ranks");
    std::filesystem::remove_all(folder_ / "refused");
    return refused.result.err;
  };
  scene_ = folder_.write("tracers.json", kTracers);
  rest_.clear();
  const std::string tracers = errorOf({}, {"--plugin", pluginOfTracers()});
  EXPECT_CONTAINS(tracers, "node 'points'");
  EXPECT_CONTAINS(tracers, "a VortexTracers cannot run on several ranks yet");
}

/// On a machine with one GPU, all ranks share it.
class GpuRanksTest : public RanksTest {
 protected:
  void SetUp() override {
    const std::vector<std::string>& devices = availableDevices();
    if (std::find(devices.begin(), devices.end(), "cuda") == devices.end()) GTEST_SKIP() << "there is no GPU";
    device_ = {"--device", "cuda"};
  }
};

TEST_F(GpuRanksTest, ADamBreakIsTheSameForAnyNumberOfRanks) {
  expectSameForAnyNumber({kCoarse}, kFew);
}

TEST_F(GpuRanksTest, SoIsOneOfMoreThan32768ParticlesOnEachRank) {
  duration_ = "0.33";  // 10 frames
  scene_ = resourcesFolder() + "/scenes/benchmark_dam_break.json";
  expectSameForAnyNumber({"water.rest_steps=0"}, {"2", "3"});
}

TEST_F(GpuRanksTest, SoIsOneThatIsSolvedToAToleranceByConjugateGradientsInStages) {
  rest_.clear();
  scene_ = folder_.write("thrown.json", kThrown);
  expectSameForAnyNumber({"water.solver.record_objective=true"}, kFew);
}

TEST_F(GpuRanksTest, SoIsOneOfHoneyWithAGaugeOfTheFlowAndForcesOnTheTank) {
  scene_ = folder_.write("honey.json", kHoney);
  expectSameForAnyNumber({}, kFew);
}

TEST_F(GpuRanksTest, SoIsOneInAMeshWithAStirrerAnEmitterAndADrain) {
  scene_ = folder_.write("stirred.json", kStateful);
  expectSameForAnyNumber({}, kFew);
}

TEST_F(GpuRanksTest, SoIsOneThatAThinWallDividesAndABodyFloatsOn) {
  duration_ = "0.2";
  scene_ = folder_.write("divided.json", kDivided);
  expectSameForAnyNumber({}, kFew);
}

TEST_F(GpuRanksTest, ForcesOfMoreThan65536ParticlesOnARankAreTheSame) {
  scene_ = resourcesFolder() + "/scenes/benchmark_sfi.json";
  expectSameForAnyNumber({}, {"2", "3"});
}

TEST_F(RanksTest, MoreGpusThanThereAreAreRefused) {
  device_ = {"--gpus", "200"};
  const Outcome refused = run("refused", {}, {});
  EXPECT_EQ(refused.result.code, 2);
  const bool any = std::ssize(availableDevices()) > 1;
  EXPECT_CONTAINS(refused.result.err, any ? "more than this machine has" : "cuda");
}

TEST_F(RanksTest, SoIsOneWithAModuleOfAPluginThatHasTheRole) {
  duration_ = "0.1";
  scene_ = folder_.write("swirled.json", R"({
    "weir": 1,
    "world": { "dt": 0.004, "frame_rate": 100 },
    "nodes": {
      "block": { "type": "BoxSampler", "params": { "min": [-0.3, 0, -0.1], "max": [0.3, 0.2, 0.1] } },
      "water": { "type": "ParticleFluid", "params": { "spacing": 0.03 },
                 "modules": { "vortex": { "type": "VortexForce", "before": "predict", "params": { "growth": 3 } } } }
    },
    "links": ["block.particles -> water.initial"]
  })");
  device_ = {"--plugin", buildFolder() + "/lib/weir/test_plugins/weir_vortex_force.so"};
  expectSameForAnyNumber({}, {"3"});
}

TEST_F(RanksTest, AModuleThatCannotIsRefusedByItsName) {
  const std::string scene = folder_.write("s.json", R"({
    "weir": 1,
    "nodes": {
      "block": { "type": "BoxSampler" },
      "water": { "type": "ParticleFluid", "params": { "spacing": 0.1 },
                 "modules": { "up": { "type": "Lift", "after": "viscosity" } } }
    },
    "links": ["block.particles -> water.initial"]
  })");
  const ChildResult refused =
      runWeir({"run", scene, "--ranks", "2", "--plugin", buildFolder() + "/lib/weir/test_plugins/lift.so",
               "--stats", folder_ / "s.stats.json"});
  EXPECT_EQ(refused.code, 3);
  EXPECT_CONTAINS(refused.err, "node 'water'");
  EXPECT_CONTAINS(refused.err, "the module 'up' of type Lift cannot run on several ranks yet");
}

}  // namespace
}  // namespace weir::test
