// `weir run --ranks N`: the same files for any number of ranks, and a clear word where a scene cannot.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "framework/scene/scene_file.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

/// All that is written, by name.
using Files = std::map<std::string, std::string>;

struct Run {
  ChildResult result;
  Files files;
  Value statistics;
};

class RanksTest : public testing::Test {
 protected:
  /// The dam break for 0.3 s, with what is changed.
  Run run(const std::string& name, const std::vector<std::string>& changes,
          const std::vector<std::string>& more) const {
    const std::string to = folder_ / name;
    std::filesystem::create_directory(to);
    std::vector<std::string> arguments{"run",       resourcesFolder() + "/scenes/dam_break.json",
                                       "--device",  "cpu",
                                       "--quiet",   "--duration",
                                       "0.3",       "--ply-particles",
                                       to + "/ply", "--stats",
                                       to + "/stats.json"};
    for (const std::string& change : changes) arguments.insert(arguments.end(), {"--set", change});
    arguments.insert(arguments.end(), more.begin(), more.end());
    Run run{.result = runWeir(arguments)};
    if (run.result.code != 0) return run;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(to + "/ply"))
      if (entry.is_regular_file())
        run.files[entry.path().filename().string()] = readFile(entry.path().string());
    run.statistics = parseJson(readFile(to + "/stats.json"), "stats.json");
    return run;
  }

  void expectSameForAnyNumber(const std::vector<std::string>& changes) const {
    const Run one = run("1", changes, {"--ranks", "1"});
    ASSERT_EQ(one.result.code, 0) << one.result.err;
    ASSERT_GE(one.files.size(), 10u);
    for (const std::string ranks : {"2", "3", "4", "8"}) {
      const Run several = run(ranks, changes, {"--ranks", ranks});
      ASSERT_EQ(several.result.code, 0) << several.result.err;
      ASSERT_EQ(several.files.size(), one.files.size());
      for (const auto& [file, bytes] : one.files)
        EXPECT_TRUE(several.files.at(file) == bytes) << file << " with " << ranks << " ranks";
      EXPECT_EQ(writeJson(fluidOf(several)), writeJson(fluidOf(one))) << ranks << " ranks";
    }
  }

  static const Value& fluidOf(const Run& run) { return *run.statistics.find("nodes")->find("water"); }

  TemporaryFolder folder_;
};

constexpr const char* kCoarse = "water.spacing=0.05";

TEST_F(RanksTest, ADamBreakIsTheSameForAnyNumberOfRanks) {
  expectSameForAnyNumber({kCoarse});
}

TEST_F(RanksTest, SoIsOneWithVaryingStepsFrictionAndImplicitViscosity) {
  expectSameForAnyNumber({kCoarse, "world.cfl=0.4", "world.dt=0.004", "tank.friction=0.2",
                          "tank.restitution=0.3", "water.viscosity.form=implicit",
                          "water.solver.step_length=particle", "water.pressure=true"});
}

TEST_F(RanksTest, SoIsOneWhoseParticlesLeaveTheDomain) {
  expectSameForAnyNumber({kCoarse, "water.domain_max=[0.7, 5, 5]", "water.rest_steps=0"});
}

TEST_F(RanksTest, RanksMayHaveNoParticles) {
  // Four cells along x, where the block is a bit longer, so at least half of the ranks have none.
  const std::vector<std::string> small{"water.spacing=0.05", "block.max=[0.2, 0.15, 0.15]"};
  const Run one = run("one", small, {"--ranks", "1"}), many = run("many", small, {"--ranks", "16"});
  ASSERT_EQ(one.result.code, 0) << one.result.err;
  ASSERT_EQ(many.result.code, 0) << many.result.err;
  EXPECT_TRUE(many.files == one.files);
}

TEST_F(RanksTest, TheyAreAsGoodAsARunWithoutThem) {
  // The order of sums differs, so the two part in time; the water does not.
  const Run with = run("with", {kCoarse}, {"--ranks", "3"}), without = run("without", {kCoarse}, {});
  ASSERT_EQ(with.result.code, 0) << with.result.err;
  ASSERT_EQ(without.result.code, 0) << without.result.err;
  const auto number = [](const Run& run, const char* name) { return fluidOf(run).find(name)->asDouble(); };
  EXPECT_EQ(number(with, "particles"), number(without, "particles"));
  EXPECT_NEAR(number(with, "kinetic_energy") / number(without, "kinetic_energy"), 1, 0.02);
  EXPECT_NEAR(number(with, "potential_energy") / number(without, "potential_energy"), 1, 0.02);
}

TEST_F(RanksTest, WhatCannotRunOnThemIsRefusedWithWhatToDo) {
  const auto errorOf = [&](const std::vector<std::string>& changes, const std::vector<std::string>& more) {
    std::vector<std::string> all{"--ranks", "2"};
    all.insert(all.end(), more.begin(), more.end());
    const Run refused = run("refused", changes, all);
    EXPECT_NE(refused.result.code, 0);
    EXPECT_CONTAINS(refused.result.err, "--ranks");
    std::filesystem::remove_all(folder_ / "refused");
    return refused.result.err;
  };
  EXPECT_CONTAINS(errorOf({"tank.report_forces=true"}, {}), "tank");
  EXPECT_CONTAINS(errorOf({"water.solver.record_objective=true"}, {}), "record_objective");
  EXPECT_CONTAINS(errorOf({"water.solver.step_length=global"}, {}), "step_length");
  EXPECT_CONTAINS(errorOf({}, {"--checkpoint", folder_ / "c.h5"}), "--checkpoint");
  EXPECT_CONTAINS(errorOf({}, {"--resume", folder_ / "c.h5"}), "--resume");
  EXPECT_CONTAINS(errorOf({}, {"--device", "cuda"}), "cuda");
  const std::string scene = folder_.write("s.json", R"({
    "weir": 1,
    "nodes": {
      "jet": { "type": "CircleEmitter" },
      "water": { "type": "ParticleFluid", "params": { "spacing": 0.05 },
                 "modules": { "curl": { "type": "VorticityConfinement", "after": "viscosity" } } }
    },
    "links": ["jet.particles -> water.emitters"]
  })");
  const ChildResult emitter = runWeir({"run", scene, "--ranks", "2", "--stats", folder_ / "s.stats.json"});
  EXPECT_EQ(emitter.code, 3);
  EXPECT_CONTAINS(emitter.err, "node 'jet'");
  EXPECT_CONTAINS(emitter.err, "a CircleEmitter cannot run on several ranks yet");
}

TEST_F(RanksTest, AModuleThatCannotIsRefusedByItsName) {
  const std::string scene = folder_.write("s.json", R"({
    "weir": 1,
    "nodes": {
      "block": { "type": "BoxSampler" },
      "water": { "type": "ParticleFluid", "params": { "spacing": 0.1 },
                 "modules": { "curl": { "type": "VorticityConfinement", "after": "viscosity" } } }
    },
    "links": ["block.particles -> water.initial"]
  })");
  const ChildResult refused = runWeir({"run", scene, "--ranks", "2", "--stats", folder_ / "s.stats.json"});
  EXPECT_EQ(refused.code, 3);
  EXPECT_CONTAINS(refused.err, "node 'water'");
  EXPECT_CONTAINS(refused.err, "the module 'curl' of type VorticityConfinement cannot run on several ranks yet");
}

TEST_F(RanksTest, ARunThatDivergesEndsOnAllRanksWithOneMessage) {
  const Run diverged =
      run("diverged", {kCoarse, "water.solver.enabled=false", "block.velocity=[1e38, 1e38, 1e38]"},
          {"--ranks", "4"});
  EXPECT_EQ(diverged.result.code, 4);
  EXPECT_CONTAINS(diverged.result.err, "rank 0");
  EXPECT_CONTAINS(diverged.result.err, "diverged");
}

}  // namespace
}  // namespace weir::test
