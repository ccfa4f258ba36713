// weir bench as a user runs it.
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <filesystem>

#include "framework/scene/scene_file.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

class Bench : public testing::Test {
 protected:
  ChildResult run(std::vector<std::string> more, const ChildOptions& options = {}) const {
    std::vector<std::string> arguments{"bench", "--device",     "cpu",  "--threads", "2", "--sizes",
                                       "4096",  "--late-after", "0.02", "--json",    json};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runWeir(arguments, options);
  }
  Value written() const { return parseJson(readFile(json), json); }

  TemporaryFolder folder;
  std::string json = folder / "bench.json";
};

double numberIn(const Value& value, const char* key) {
  const Value* member = value.find(key);
  return member != nullptr && member->isNumber() ? member->asDouble() : std::nan("");
}

TEST_F(Bench, TimesBothMomentsAndWritesThemWithTheMachine) {
  const ChildResult result = run({"--cases", "dam"});
  ASSERT_EQ(result.code, 0) << result.err;
  for (const char* part : {"early", "late", "4,096", "water/solver", json.c_str()})
    EXPECT_CONTAINS(result.out, part);
  const Value v = written();
  EXPECT_EQ(v.find("end")->asString(), "finished");
  EXPECT_CONTAINS(v.find("command")->asString(), "weir bench --device cpu --threads 2");
  const double bandwidth = numberIn(v, "copy_bytes_per_second");
  EXPECT_GT(bandwidth, 1e8);
  const Value& machine = *v.find("machine");
  for (const char* key : {"commit", "compiler", "build_type", "cpu", "date", "system", "version"})
    EXPECT_FALSE(machine.find(key)->asString().empty()) << key;
  EXPECT_EQ(numberIn(*machine.find("device"), "threads"), 2);
  EXPECT_FALSE(machine.find("device")->find("isa")->asString().empty());

  ASSERT_EQ(v.find("results")->asArray().size(), 1u);
  const Value& dam = v.find("results")->asArray()[0];
  EXPECT_EQ(numberIn(dam, "size"), 4096);
  const auto& moments = dam.find("moments")->asArray();
  ASSERT_EQ(moments.size(), 2u);
  const double times[][2] = {{0.02, 0.12}, {0.14, 0.24}};
  for (std::size_t k = 0; k < moments.size(); ++k) {
    const Value& moment = moments[k];
    EXPECT_NEAR(numberIn(moment, "from"), times[k][0], 1e-9);
    EXPECT_NEAR(numberIn(moment, "to"), times[k][1], 1e-9);
    EXPECT_EQ(numberIn(moment, "particles"), 4096);
    EXPECT_GE(numberIn(moment, "timed_steps"), 30);
    EXPECT_GT(numberIn(moment, "step_ms_median"), 0);
    EXPECT_LE(numberIn(moment, "step_ms_median"), numberIn(moment, "step_ms_p95"));
    EXPECT_GT(numberIn(moment, "batch_step_ms_mean"), 0);
    EXPECT_GT(numberIn(moment, "neighbors_mean"), 4);  // 6 in the lattice, fewer at its surface
    EXPECT_LT(numberIn(moment, "neighbors_mean"), 15);
    EXPECT_LT(numberIn(moment, "compression_mean"), 0.1);
    EXPECT_GT(numberIn(*moment.find("modules_ms"), "water/solver"), 0);
    // Three iterations and one sweep, counted anew: 4n for the lists of 7 passes, and what is with them.
    const double bytes = 64 + 24 + 2 * 20 + 3 * 36 + 48 + 80 + 7 * 4 * numberIn(moment, "neighbors_mean");
    EXPECT_NEAR(numberIn(moment, "least_bytes_per_particle"), bytes, 1e-6);
    const double seconds = 1e-3 * numberIn(moment, "step_ms_median");
    EXPECT_NEAR(numberIn(moment, "share_of_copy_bandwidth"), bytes * 4096 / seconds / bandwidth, 1e-6);
  }
  // Position, velocity and density at the least.
  const double each = numberIn(*dam.find("memory"), "bytes_per_particle");
  EXPECT_GT(each, 28);
  EXPECT_NEAR(numberIn(*dam.find("memory"), "peak_bytes"), each * 4096, 1);
}

TEST_F(Bench, TheScenesCanBeRunAsTheyAreTold) {
  ASSERT_EQ(run({"--cases", "dam-3-sweeps"}).code, 0);
  const Value v = written();
  const Value& result = v.find("results")->asArray()[0];
  const std::string stats = folder / "stats.json";
  const std::string resources = resourcesFolder();
  std::vector<std::string> arguments{
      "run",      resources.substr(0, resources.rfind("resources")) + result.find("scene")->asString(),
      "--device", "cpu",
      "--stats",  stats,
      "--quiet"};
  for (const Value& set : result.find("set")->asArray()) {
    arguments.push_back("--set");
    arguments.push_back(set.asString());
  }
  arguments.insert(arguments.end(), {"--frames", "6"});
  const ChildResult again = runWeir(arguments);
  ASSERT_EQ(again.code, 0) << again.err;
  const Value water = *parseJson(readFile(stats), stats).find("nodes")->find("water");
  const Value& early = result.find("moments")->asArray()[0];  // which ends at the same frame
  EXPECT_EQ(numberIn(*water.find("neighbors"), "mean"), numberIn(early, "neighbors_mean"));
  EXPECT_EQ(numberIn(*water.find("compression"), "mean"), numberIn(early, "compression_mean"));
}

TEST_F(Bench, CasesWithoutSizesHaveNone) {
  ASSERT_EQ(run({"--cases", "goblet"}).code, 0);
  const Value v = written();
  const Value& goblet = v.find("results")->asArray()[0];
  EXPECT_EQ(goblet.find("size"), nullptr);
  const auto& moments = goblet.find("moments")->asArray();
  ASSERT_EQ(moments.size(), 1u);
  EXPECT_EQ(moments[0].find("moment")->asString(), "late");
  EXPECT_GT(numberIn(moments[0], "particles"), 500);
  EXPECT_EQ(moments[0].find("share_of_copy_bandwidth"), nullptr);  // nobody has counted its bytes
}

TEST_F(Bench, ARunThatDivergedHasNoSpeed) {
  // The upper half of the block is outside of this domain and is removed.
  const ChildResult result =
      run({"--cases", "dam", "--set", "water.domain_min=[-1,-1,-1]", "--set", "water.domain_max=[3,0.4,3]"});
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_CONTAINS(result.out, "diverged: ");
  EXPECT_CONTAINS(result.out, "particles left the domain");
  const Value v = written();
  const auto& moments = v.find("results")->asArray()[0].find("moments")->asArray();
  ASSERT_EQ(moments.size(), 1u);  // nothing is timed after that
  EXPECT_CONTAINS(moments[0].find("diverged")->asString(), "left the domain");
  for (const char* key : {"step_ms_median", "batch_step_ms_mean", "modules_ms", "share_of_copy_bandwidth"})
    EXPECT_EQ(moments[0].find(key), nullptr) << key;
}

TEST_F(Bench, TooMuchCompressionIsNoLiquid) {
  const ChildResult result = run({"--cases", "dam", "--set", "world.gravity=[0,-5000,0]"});
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_CONTAINS(result.out, "the mean compression is ");
  EXPECT_CONTAINS(result.out, "above the limit of 0.5");
}

TEST_F(Bench, ARunThatBreaksOffSaysWhy) {
  const ChildResult result = run({"--cases", "dam", "--set", "world.gravity=[0,-1e30,0]"});
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_CONTAINS(result.out, "failed: ");
  const Value v = written();
  EXPECT_CONTAINS(v.find("results")->asArray()[0].find("failed")->asString(), "NaN or infinite");
}

TEST_F(Bench, AnySizeGetsTheNearestBlock) {
  ASSERT_EQ(run({"--cases", "dam", "--sizes", "5000"}).code, 0);
  EXPECT_EQ(numberIn(written().find("results")->asArray()[1], "size"), 17 * 17 * 17);
}

TEST_F(Bench, WhatIsNotThereIsAnErrorThatSaysWhatIs) {
  const auto refuse = [&](std::vector<std::string> arguments, int code,
                          std::initializer_list<const char*> parts) {
    const ChildResult result = run(std::move(arguments));
    EXPECT_EQ(result.code, code) << result.err;
    EXPECT_EQ(result.out, "");
    for (const char* part : parts) EXPECT_CONTAINS(result.err, part);
    EXPECT_FALSE(std::filesystem::exists(json));
  };
  refuse({"--cases", "dam,gobblet"}, 2,
         {"--cases: there is no 'gobblet'", "dam-pbf", "did you mean 'goblet'?"});
  refuse({"--sizes", "0"}, 2, {"--sizes", "64"});
  refuse({"--sizes", "many"}, 2, {"--sizes"});
  refuse({"--late-after", "-1"}, 2, {"--late-after"});
  refuse({"--threads", "0"}, 2, {"--threads"});
  refuse({"--cases", "dam", "--set", "water.spacign=1"}, 3,
         {"--set water.spacign=1", "did you mean 'spacing'?"});
  EXPECT_EQ(runWeir({"bench", "--json", "/proc/bench.json"}).code, 5);
  EXPECT_CONTAINS(runWeir({"bench", "--device", "tpu"}).err, "tpu");
}

TEST_F(Bench, AnInterruptedOneKeepsWhatItHas) {
  ChildOptions options;
  bool sent = false;
  options.onStderr = [&](int pid, const std::string& err) {
    if (!sent && contains(err, "late: ")) sent = kill(pid, SIGINT) == 0;
  };
  const ChildResult result = runWeir({"bench", "--device", "cpu", "--cases", "dam", "--sizes", "4096",
                                      "--late-after", "1000", "--json", json},
                                     options);
  EXPECT_EQ(result.code, 130) << result.err;
  const Value v = written();
  EXPECT_EQ(v.find("end")->asString(), "interrupted");
  EXPECT_TRUE(v.find("results")->asArray()[0].find("interrupted")->asBool());
  const auto& moments = v.find("results")->asArray()[0].find("moments")->asArray();
  ASSERT_EQ(moments.size(), 1u);
  EXPECT_EQ(moments[0].find("moment")->asString(), "early");
}

}  // namespace
}  // namespace weir::test
