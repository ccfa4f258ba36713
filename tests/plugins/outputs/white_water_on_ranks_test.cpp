// White water where ranks share the fluid: that of one rank, in all files and numbers.
#include "tests/plugins/outputs/ranks_run.h"

namespace weir::test {
namespace {

/// Water is thrown at a wall beside a mesh that moves, a jet falls into it, and some flows out. Much of the
/// white water lives shorter than the run, and not all that is wanted is made.
constexpr const char* kWhite = R"({
  "weir": 1,
  "world": { "dt": 0.004, "frame_rate": 50, "seed": 3 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.4, 0.3, 0.3], "velocity": [5, 1, 0] } },
    "jet": { "type": "CircleEmitter",
             "params": { "position": [0.15, 0.6, 0.15], "rotation": [0, 0, 20], "radius": 0.09, "speed": 3 } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [-0.05, 0, 0], "max": [0.9, 1, 0.3], "inverted": true } },
    "hole": { "type": "Sink", "params": { "min": [0.7, 0, 0], "max": [0.9, 0.08, 0.3] } },
    "bar": { "type": "BoxMesh", "params": { "min": [0.5, 0.1, -0.1], "max": [0.53, 0.2, 0.4] } },
    "beam": { "type": "SemiAnalyticalSFI", "params": { "velocity": [0.2, 0.1, 0] } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.04, "support_ratio": 1.5, "rest_steps": 0 },
               "modules": { "viscosity": { "params": { "rate": 75 } } } },
    "foam": { "type": "WhiteWater",
              "params": { "trapped_air": 6e5, "wave_crests": 2e6, "air_limits": [0.02, 0.3], "crest_limits": [1, 10],
                          "lifetime": [0.05, 0.2], "max_particles": 8000 } }
  },
  "links": ["block.particles -> water.initial", "jet.particles -> water.emitters", "tank.boundary -> water.boundaries",
            "hole.sink -> water.sinks", "bar.surface -> beam.solids", "water.fluid -> beam.fluid",
            "water.fluid -> foam.fluid"]
})";

class WhiteWaterOnRanks : public RanksTest {
 protected:
  WhiteWaterOnRanks() { scene_ = folder_.write("white.json", kWhite); }

  /// Of the white water.
  static std::int64_t number(const Value& statistics, const char* name) {
    return statistics.find("nodes")->find("foam")->find(name)->asInt();
  }
};

TEST_F(WhiteWaterOnRanks, IsTheSameForAnyNumberOfThem) {
  expectSameForAnyNumber({}, {"2", "4"});
  const Value statistics = parseJson(readFile(folder_ / "4/stats.json"), "stats.json");
  for (const char* kind : {"spray", "foam", "bubbles"}) EXPECT_GT(number(statistics, kind), 15) << kind;
  EXPECT_GT(number(statistics, "particles_made"), number(statistics, "particles") + 1000);
  EXPECT_GT(number(statistics, "particles_removed"), 10);
  EXPECT_GT(number(statistics, "particles_refused"), 1000);
  const Value& foam = *statistics.find("ranks")->find("foam");
  EXPECT_EQ(foam.find("gathered")->asInt(), number(statistics, "particles"));
  EXPECT_GT(foam.find("particles")->find("mean")->asDouble(), 100);
  EXPECT_GT(foam.find("fluid_of_others")->find("max")->asDouble(), 0);
}

TEST_F(WhiteWaterOnRanks, IsTheSameWithoutALimitInStepsOfTheFluid) {
  expectSameForAnyNumber({"foam.max_particles=1000000", "foam.max_dt=0", "foam.seed=9"}, {"3"});
}

TEST_F(WhiteWaterOnRanks, IsTheSameOnProcessesOfMpi) {
  if (!hasMpi()) GTEST_SKIP() << "there is no MPI, or it was not there when this was built";
  const Outcome threads = run("threads", {}, {"--ranks", "3"}), processes = run("mpi", {}, {}, 2);
  ASSERT_EQ(threads.result.code, 0) << threads.result.err;
  ASSERT_EQ(processes.result.code, 0) << processes.result.err;
  EXPECT_TRUE(processes.files == threads.files);
  EXPECT_EQ(writeJson(*processes.statistics.find("nodes")), writeJson(*threads.statistics.find("nodes")));
}

TEST_F(WhiteWaterOnRanks, GoesOnFromACheckpointOfAnyNumberOfThem) {
  const std::string seed = "foam.seed=4";
  const Outcome whole = run("whole", {seed}, {"--ranks", "2", "--frames", "8"});
  ASSERT_EQ(whole.result.code, 0) << whole.result.err;
  for (const std::string from : {"1", "3"}) {
    const std::string checkpoint = folder_ / (from + ".h5");
    const ChildResult begun = save(checkpoint, seed, {"--ranks", from});
    ASSERT_EQ(begun.code, 0) << begun.err;
    for (const std::string to : {"1", "2", "4"})
      expectSameEnd(run(from + "to" + to, {seed}, {"--ranks", to, "--frames", "8", "--resume", checkpoint}),
                    whole, "from " + from + " to " + to);
  }
  const Outcome alone =
      run("alone", {seed}, {"--device", "cpu", "--frames", "8", "--resume", folder_ / "3.h5"});
  EXPECT_EQ(alone.result.code, 0) << alone.result.err;
}

TEST_F(WhiteWaterOnRanks, IsAsMuchAsWithoutThem) {
  rest_.clear();  // what follows steps to rest that are broken off differs by up to a tenth
  const auto madeBy = [&](const std::string& name, const std::vector<std::string>& more) {
    const Outcome outcome = run(name, {"foam.max_particles=1000000"}, more);
    EXPECT_EQ(outcome.result.code, 0) << outcome.result.err;
    return static_cast<double>(number(outcome.statistics, "particles_made"));
  };
  // Sums of the fluid have another order.
  EXPECT_NEAR(madeBy("with", {"--ranks", "3"}) / madeBy("without", {"--device", "cpu"}), 1, 0.05);
}

TEST_F(WhiteWaterOnRanks, NeedsNoParticlesOfOthersWhereNobodyLooks) {
  const ChildResult result = runWeir(
      {"run", scene_, "--quiet", "--duration", "0.1", "--ranks", "3", "--stats", folder_ / "stats.json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const Value ranks = *parseJson(readFile(folder_ / "stats.json"), "stats.json").find("ranks");
  for (const char* node : {"water", "foam"})
    EXPECT_EQ(ranks.find(node)->find("gathered")->asInt(), 0) << node;
}

}  // namespace
}  // namespace weir::test
