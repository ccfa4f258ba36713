// Steps whose length follows the motion: what a node asks for decides, and frames stay at their times.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "framework/run/progress.h"
#include "framework/run/run.h"
#include "framework/run/statistics.h"
#include "framework/scene/scene_file.h"
#include "tests/support/expect_error.h"

namespace weir {
namespace {

/// Asks for steps of a length that it is given over time.
class Wisher final : public Node {
 public:
  static constexpr NodeInfo kInfo{"Wisher", "Asks for steps of a length."};
  const NodeInfo& info() const override { return kInfo; }
  Param<double> wish{*this, "wish", 1, {.unit = "s", .animated = true, .doc = "Longest step times 1/cfl."}};
  void reset(const SetupContext& context) override {
    steps.clear();
    setupDt = context.dt;
    setupVaries = context.stepsVary;
  }
  double longestStep(const StepContext& next, double cfl) override {
    ++asked;
    longestOffered = std::max(longestOffered, next.dt);
    return cfl * wish;
  }
  void step(const StepContext& c) override { steps.push_back({c.time, c.dt}); }
  struct Step {
    double time, dt;
    bool operator==(const Step&) const = default;
  };
  std::vector<Step> steps;
  double setupDt = 0, longestOffered = 0;
  bool setupVaries = false;
  int asked = 0;
};

class TimeStep : public testing::Test {
 protected:
  TimeStep() { registry_.addNode<Wisher>(); }

  std::unique_ptr<Simulation> simulation(const std::string& world, const std::string& wish = "0.01") {
    const std::string text = R"({"weir": 1, "world": {)" + world + R"(},
        "nodes": {"w": {"type": "Wisher", "params": {"wish": )" +
                             wish + "}}}}";
    std::vector<std::string> warnings;
    auto scene = buildScene(parseJson(text, "s.json"), {"s.json", "", "/"}, registry_, {}, warnings);
    return std::make_unique<Simulation>(std::move(scene), *device_, log_, registry_);
  }
  static Wisher& wisher(Simulation& s) { return static_cast<Wisher&>(*s.scene().graph.find("w")); }

  std::unique_ptr<Device> device_ = openDevice("cpu");
  Log log_;
  Registry registry_;
};

TEST_F(TimeStep, EvenStepsMeetATimeWithoutASliver) {
  EXPECT_EQ(evenStep(1, 2), 1);
  EXPECT_EQ(evenStep(1, 1), 1);
  EXPECT_EQ(evenStep(1, 0.9), 0.5);
  EXPECT_EQ(evenStep(0.3, 0.1), 0.3 / 3);                // though 0.3/0.1 is a little below 3
  EXPECT_EQ(evenStep(0.1 + 0.2, 0.1), (0.1 + 0.2) / 3);  // and this quotient a little above
  EXPECT_EQ(evenStep(1, std::numeric_limits<double>::infinity()), 1);
}

TEST_F(TimeStep, FramesStayAtTheirTimesWhateverIsAskedFor) {
  const auto s = simulation(R"("dt": 0.02, "cfl": 0.5, "frame_rate": 30, "duration": 0.517)",
                            R"({"keyframes": [[0, 0.03], [0.2, 0.0011], [0.5, 0.09]]})");
  s->reset();
  const std::atomic<bool> stop = false;
  std::int64_t steps = 0;
  for (int frame = 1; frame <= 15; ++frame) {
    ASSERT_TRUE(s->advanceFrame(stop));
    EXPECT_EQ(s->time(), frame / 30.0);
    EXPECT_TRUE(s->atFrame());
    EXPECT_GT(s->stepsDone(), steps);
    steps = s->stepsDone();
  }
  ASSERT_TRUE(s->finishRest(stop));
  EXPECT_EQ(s->time(), 0.517);
  const Wisher& w = wisher(*s);
  ASSERT_EQ(std::int64_t(w.steps.size()), s->stepsDone());
  double shortest = 1, longest = 0;
  for (std::size_t k = 0; k < w.steps.size(); ++k) {
    const auto [time, dt] = w.steps[k];
    const double next = k + 1 < w.steps.size() ? w.steps[k + 1].time : 0.517;
    EXPECT_NEAR(next - time, dt, 1e-15) << k;  // nothing is left out or done twice
    // What was asked for, from the keyframes by hand.
    const double wish = time < 0.2 ? 0.03 + (0.0011 - 0.03) * time / 0.2
                                   : 0.0011 + (0.09 - 0.0011) * std::min(1.0, (time - 0.2) / 0.3);
    const double limit = std::min(0.02, 0.5 * wish);
    EXPECT_LE(dt, limit * (1 + 1e-8)) << time;
    // Dividing what remains evenly never takes more than half of what is allowed away, but for the last one.
    const double end = std::min(0.517, (std::floor(time * 30 + 1e-9) + 1) / 30);
    EXPECT_GE(dt, std::min(0.5 * limit, end - time) * (1 - 1e-8)) << time;
    shortest = std::min(shortest, dt), longest = std::max(longest, dt);
  }
  EXPECT_EQ(s->stepLengths().shortest, shortest);
  EXPECT_EQ(s->stepLengths().longest, longest);
  EXPECT_EQ(s->stepLengths().tooLong, 0);
  EXPECT_LT(shortest, 0.001);
  EXPECT_GT(longest, 0.015);
  EXPECT_EQ(w.longestOffered, 0.02);
  EXPECT_EQ(w.setupDt, 0.02);
  EXPECT_TRUE(w.setupVaries);
  const Value statistics = runStatistics(*s, RunEnd::kFinished);
  EXPECT_NEAR(statistics.find("time_step")->find("mean")->asDouble(), 0.517 / double(w.steps.size()), 1e-15);
}

TEST_F(TimeStep, EqualWishesMakeEqualSteps) {
  const auto s = simulation(R"("dt": 0.1, "cfl": 0.4, "frame_rate": 10, "duration": 0.3)", "0.0175");
  EXPECT_EQ(runSimulation(*s, {}), RunEnd::kFinished);
  EXPECT_EQ(s->stepsDone(), 3 * 15);  // 0.1/0.007 = 14.3
  for (const Wisher::Step& step : wisher(*s).steps) EXPECT_NEAR(step.dt, 0.1 / 15, 1e-15);
}

TEST_F(TimeStep, AResetStartsAgain) {
  const auto s = simulation(R"("dt": 0.02, "cfl": 1, "min_dt": 0.008, "frame_rate": 10, "duration": 0.3)",
                            R"({"keyframes": [[0, 0.005], [0.3, 0.02]]})");
  runSimulation(*s, {});
  const auto first = wisher(*s).steps;
  const auto tooLong = s->stepLengths().tooLong;
  EXPECT_GT(tooLong, 0);
  runSimulation(*s, {});
  EXPECT_EQ(wisher(*s).steps, first);
  EXPECT_EQ(s->stepLengths().tooLong, tooLong);
}

TEST_F(TimeStep, AnInterruptedRunGoesOnWhereItWas) {
  const char* world = R"("dt": 0.02, "cfl": 1, "frame_rate": 5, "duration": 0.4)";
  const auto whole = simulation(world, "0.013"), parts = simulation(world, "0.013");
  runSimulation(*whole, {});
  std::atomic<bool> stop = false;
  parts->reset();
  EXPECT_FALSE(parts->advanceFrame(stop, [&] { stop = parts->stepsDone() == 5; }));
  EXPECT_FALSE(parts->atFrame());
  stop = false;
  while (parts->advanceFrame(stop)) {
  }
  EXPECT_EQ(wisher(*parts).steps, wisher(*whole).steps);
}

TEST_F(TimeStep, MinDtBoundsWhatIsAskedForAndIsReported) {
  for (const char* wish : {"0.001", "0", "-1"}) {
    const auto s =
        simulation(R"("dt": 0.05, "cfl": 1, "min_dt": 0.005, "frame_rate": 10, "duration": 0.1)", wish);
    EXPECT_EQ(runSimulation(*s, {}), RunEnd::kFinished);
    EXPECT_EQ(s->stepsDone(), 20) << wish;
    EXPECT_EQ(s->stepLengths().tooLong, 20);
    const auto texts = rareEventTexts(runStatistics(*s, RunEnd::kFinished));
    ASSERT_EQ(texts.size(), 1u);
    EXPECT_CONTAINS(texts[0], "world: 20 steps were longer than cfl allows");
    EXPECT_CONTAINS(texts[0], "min_dt");
    EXPECT_CONTAINS(texts[0], std::string(wish) + " s would");
  }
  // Without it, a thousandth of dt.
  const auto s = simulation(R"("dt": 0.05, "cfl": 1, "frame_rate": 10, "duration": 0.1)", "1e-12");
  runSimulation(*s, {});
  EXPECT_EQ(s->stepsDone(), 2000);
}

TEST_F(TimeStep, WithoutCflNobodyIsAskedAndStepsAreEqual) {
  const auto s = simulation(R"("dt": 0.03, "frame_rate": 10, "duration": 0.2)");
  runSimulation(*s, {});
  EXPECT_EQ(wisher(*s).asked, 0);
  EXPECT_FALSE(wisher(*s).setupVaries);
  ASSERT_EQ(s->stepsDone(), 8);
  for (const Wisher::Step& step : wisher(*s).steps) EXPECT_EQ(step.dt, 0.1 / 4);
  EXPECT_EQ(s->stepLengths().shortest, 0.1 / 4);
}

TEST_F(TimeStep, ProgressTellsTheTimeLeftFromTheSimulatedTime) {
  double now = 0;
  Progress progress([](std::string_view) {}, [] { return std::optional<int>(); }, [&] { return now; });
  ProgressState state{.lastFrame = 10, .endTime = 10};
  progress.update(state);
  // 1 simulated second in 8 seconds, by many steps or few.
  now = 8;
  state.time = 1, state.steps = 1000, state.frame = 1;
  progress.update(state);
  EXPECT_CONTAINS(progress.text(state), "1:12 left");
  state.time = 10;
  EXPECT_EQ(progress.text(state).find("left"), std::string::npos);
}

TEST_F(TimeStep, WrongSettingsNameTheirPlace) {
  const auto error = [&](const char* world) { return test::errorOf([&] { simulation(world); }); };
  Error e = error(R"("cfl": -0.4)");
  EXPECT_EQ(e.location().pointer, "/world/cfl");
  EXPECT_CONTAINS(e.what(), "-0.4");
  EXPECT_EQ(error(R"("cfl": 0)").location().pointer, "/world/cfl");
  EXPECT_EQ(error(R"("cfl": "fast")").location().pointer, "/world/cfl");
  EXPECT_EQ(error(R"("cfl": true)").location().pointer, "/world/cfl");
  EXPECT_EQ(error(R"("cfl": 1, "min_dt": 0)").location().pointer, "/world/min_dt");
  e = error(R"("min_dt": 0.0001)");
  EXPECT_EQ(e.location().parameter, "min_dt");
  EXPECT_CONTAINS(e.what(), "without cfl");
  e = error(R"("cfl": 1, "dt": 0.001, "min_dt": 0.002)");
  EXPECT_EQ(e.location().parameter, "min_dt");
  EXPECT_CONTAINS(e.what(), "0.002");
  e = error(R"("cfl": 1, "min_dt": 1e-15)");  // could not end
  EXPECT_EQ(e.location().parameter, "min_dt");
  EXPECT_CONTAINS(e.what(), "steps in a frame");
}

}  // namespace
}  // namespace weir
