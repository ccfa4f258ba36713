// `weir run --ranks N`: what its numbers say, what is gathered for them, and the memory that is foretold.
#include "tests/plugins/outputs/ranks_run.h"

namespace weir::test {
namespace {

/// What --stats has of so many frames of a scene of the repository, without rest steps.
Value statisticsOfRun(const std::string& to, const std::string& scene, const std::string& frames,
                      const std::vector<std::string>& changes, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"run",
                                     resourcesFolder() + "/scenes/" + scene + ".json",
                                     "--quiet",
                                     "--frames",
                                     frames,
                                     "--stats",
                                     to,
                                     "--set",
                                     "water.rest_steps=0"};
  for (const std::string& change : changes) arguments.insert(arguments.end(), {"--set", change});
  arguments.insert(arguments.end(), more.begin(), more.end());
  const ChildResult result = runWeir(arguments);
  EXPECT_EQ(result.code, 0) << result.err;
  return parseJson(readFile(to), to);
}

TEST_F(RanksTest, WhereOnlyNumbersAreWrittenNothingIsGathered) {
  const auto statisticsOf = [&](const std::string& name, const std::vector<std::string>& more) {
    return statisticsOfRun(folder_ / (name + ".json"), "dam_break", "3",
                           {kCoarse, "block.velocity=[0.5, 0, -0.25]"}, more);
  };
  const Value watched = statisticsOf("watched", {"--ranks", "3", "--ply-particles", folder_ / "ply"});
  const Value& reportOfWatched = *watched.find("ranks")->find("water");
  EXPECT_EQ(reportOfWatched.find("gathered")->asInt(), 1000);
  for (const std::string ranks : {"1", "2", "3", "4"}) {
    const Value numbers = statisticsOf("only" + ranks, {"--ranks", ranks});
    EXPECT_EQ(writeJson(*numbers.find("nodes")), writeJson(*watched.find("nodes"))) << ranks;
    const Value& report = *numbers.find("ranks")->find("water");
    EXPECT_EQ(report.find("ranks")->asInt(), std::stoi(ranks));
    EXPECT_EQ(report.find("gathered")->asInt(), 0);
    EXPECT_DOUBLE_EQ(report.find("particles")->find("mean")->asDouble(), 1000.0 / std::stoi(ranks));
    // Steps have waited for others, for migration at least.
    const Value& times = *report.find("step_ms");
    for (const char* work : {"migration", "halo", "sums"})
      EXPECT_GT(times.find(work)->find("max")->asDouble(), 0) << work;
    EXPECT_EQ(times.find("gathering")->find("max")->asDouble(), 0);
  }
}

TEST_F(RanksTest, TheirMemoryIsForetoldWithWhatIsGathered) {
  const auto memoryOf = [&](const std::string& name, const std::string& ranks, std::vector<std::string> more,
                            const std::string& frames = "1") {
    more.insert(more.end(), {"--ranks", ranks});
    const Value all = statisticsOfRun(folder_ / (name + ".json"), "benchmark_dam_break", frames,
                                      {"world.dt=0.0005", "world.frame_rate=1000"}, more);
    const double peaks =
        all.find("ranks")->find("water")->find("device_peak_bytes")->find("mean")->asDouble() *
        std::stod(ranks);
    return std::pair(all.find("memory")->find("device_estimated_bytes")->asDouble(), peaks);
  };
  // 531,441 particles, so that a layer is a part that can be seen.
  for (const std::string ranks : {"1", "2", "4"}) {
    const auto [foretold, peaks] = memoryOf("only" + ranks, ranks, {});
    EXPECT_NEAR(foretold / peaks, 1, 0.05) << ranks;
    // What the first frame's checkpoint needs would be in the peak that the second one tells.
    const auto [foretoldSaved, saved] = memoryOf(
        "saved" + ranks, ranks, {"--checkpoint", folder_ / (ranks + ".h5"), "--checkpoint-every", "1"}, "2");
    EXPECT_NEAR(foretoldSaved / saved, 1, 0.05) << ranks;
    EXPECT_NEAR(saved / peaks, 1, 0.01) << ranks;
    const auto [foretoldGathered, gathered] =
        memoryOf("ply" + ranks, ranks, {"--ply-particles", folder_ / ranks});
    EXPECT_NEAR(foretoldGathered / gathered, 1, 0.05) << ranks;
    // Positions, velocities, ids and densities of all, and of one attribute what is on its way.
    constexpr double kAll = 531'441, kGathered = kAll * (12 + 12 + 8 + 4);
    EXPECT_GT(gathered - peaks, 0.95 * kGathered) << ranks;
    EXPECT_LT(gathered - peaks, 1.05 * kGathered + 12 * kAll) << ranks;
  }
}

/// Then most particles go to another rank at once.
TEST_F(RanksTest, SoIsTheirMemoryWhereAnotherAxisBecomesTheLongest) {
  for (const std::string ranks : {"2", "4"}) {
    // A plane more along y than along the others, and two fewer after a frame of falling onto the floor.
    const Value all = statisticsOfRun(folder_ / "stats.json", "benchmark_dam_break", "1",
                                      {"world.dt=0.0005", "world.frame_rate=1000",
                                       "block.velocity=[0, -20, 0]", "block.max=[0.81, 0.82, 0.81]"},
                                      {"--ranks", ranks});
    const Value& water = *all.find("ranks")->find("water");
    const double peaks = water.find("device_peak_bytes")->find("mean")->asDouble() * std::stod(ranks);
    EXPECT_NEAR(all.find("memory")->find("device_estimated_bytes")->asDouble() / peaks, 1, 0.05) << ranks;
  }
}

TEST_F(RanksTest, TheirNumbersAreThoseOfARunWithoutThem) {
  const auto numbersOf = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> changes{kCoarse, "water.rest_steps=0", "block.velocity=[0.5, 0, -0.25]"};
    std::vector<std::string> arguments{"--frames", "0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(name, changes, arguments);
    EXPECT_EQ(outcome.result.code, 0) << outcome.result.err;
    return fluidOf(outcome);
  };
  const Value with = numbersOf("with", {"--ranks", "3"}), without = numbersOf("without", {"--device", "cpu"});
  for (const char* name : {"particles", "kinetic_energy", "potential_energy", "max_speed"})
    EXPECT_NEAR(with.find(name)->asDouble() / without.find(name)->asDouble(), 1, 1e-12) << name;
  for (int axis = 0; axis < 3; ++axis)
    for (const char* name : {"linear_momentum", "center_of_mass"})
      EXPECT_NEAR(with.find(name)->asArray()[std::size_t(axis)].asDouble(),
                  without.find(name)->asArray()[std::size_t(axis)].asDouble(), 1e-12)
          << name << axis;
  EXPECT_EQ(writeJson(*with.find("bounds")), writeJson(*without.find("bounds")));
  EXPECT_EQ(writeJson(*with.find("neighbors")), writeJson(*without.find("neighbors")));
  // Densities are sums of floats, in another order.
  for (const char* part : {"mean", "max"})
    EXPECT_NEAR(with.find("compression")->find(part)->asDouble(),
                without.find("compression")->find(part)->asDouble(), 1e-6)
        << part;
}

}  // namespace
}  // namespace weir::test
