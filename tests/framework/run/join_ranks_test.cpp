// A scene on several ranks: nodes that cannot are refused, all ranks stop at one step, and one that fails
// ends all.
#include "framework/run/join_ranks.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "framework/communication/on_ranks.h"
#include "framework/communication/thread_ranks.h"
#include "framework/scene/scene_file.h"
#include "tests/support/expect_error.h"

namespace weir {
namespace {

using test::errorOf;

/// Counts steps; fails in one of them on one rank, if told to.
class Counter final : public Node, public OnRanks {
 public:
  static constexpr NodeInfo kInfo{"Counter", "Counts steps."};
  const NodeInfo& info() const override { return kInfo; }
  Param<int> failsAt{*this, "fails_at", -1, {.doc = "The step that fails."}};
  Param<int> failsOn{*this, "fails_on", 0, {.doc = "The rank that fails."}};
  void join(Communicator& ranks) override {
    if (failsOn >= 100) throw sceneError("there are no such ranks", "fewer");
    ranks_ = &ranks;
  }
  void reset(const SetupContext&) override { steps = 0; }
  void step(const StepContext& context) override {
    if (context.index == failsAt && ranks_->rank() == failsOn) throw simulationError("boom");
    ++steps;
  }
  int steps = 0;

 private:
  Communicator* ranks_ = nullptr;
};

class Loner final : public Node {
 public:
  static constexpr NodeInfo kInfo{"Loner", "Knows no ranks."};
  const NodeInfo& info() const override { return kInfo; }
  void reset(const SetupContext&) override {}
};

class JoinRanks : public testing::Test {
 protected:
  JoinRanks() {
    registry_.addNode<Counter>();
    registry_.addNode<Loner>();
  }
  std::unique_ptr<Simulation> simulationOf(const std::string& nodes, Device& device) {
    const std::string text = R"({"weir": 1, "world": {"dt": 0.01, "frame_rate": 10, "duration": 1},
                                 "nodes": {)" +
                             nodes + "}}";
    std::vector<std::string> ignored;
    auto scene = buildScene(parseJson(text, "s.json"), {"s.json", "", "/"}, registry_, {}, ignored);
    return std::make_unique<Simulation>(std::move(scene), device, log_, registry_);
  }

  Registry registry_;
  Log log_;
};

TEST_F(JoinRanks, ANodeThatCannotIsRefusedByItsNameAndType) {
  CpuDevice device(1);
  const auto simulation = simulationOf(R"("c": {"type": "Counter"}, "alone": {"type": "Loner"})", device);
  runOnThreads(1, [&](Communicator& ranks) {
    const Error error = errorOf([&] { joinRanks(*simulation, ranks); });
    EXPECT_EQ(error.kind(), ErrorKind::kScene);
    EXPECT_EQ(error.location().node, "alone");
    EXPECT_CONTAINS(error.what(), "a Loner cannot run on several ranks yet");
    EXPECT_CONTAINS(error.what(), "--ranks");
  });
}

TEST_F(JoinRanks, WhatANodeRefusesNamesTheNode) {
  CpuDevice device(1);
  const auto simulation = simulationOf(R"("c": {"type": "Counter", "params": {"fails_on": 100}})", device);
  runOnThreads(1, [&](Communicator& ranks) {
    const Error error = errorOf([&] { joinRanks(*simulation, ranks); });
    EXPECT_EQ(error.location().node, "c");
    EXPECT_CONTAINS(error.what(), "there are no such ranks");
  });
}

TEST_F(JoinRanks, AllStopAtTheSameStepWhenOneIsAskedTo) {
  constexpr int kRanks = 3, kStep = 17;
  std::vector<std::unique_ptr<CpuDevice>> devices;
  std::vector<std::unique_ptr<Simulation>> simulations;
  for (int rank = 0; rank < kRanks; ++rank) {
    devices.push_back(std::make_unique<CpuDevice>(1));
    simulations.push_back(simulationOf(R"("c": {"type": "Counter"})", *devices.back()));
  }
  runOnThreads(kRanks, [&](Communicator& ranks) {
    Simulation& simulation = *simulations[std::size_t(ranks.rank())];
    joinRanks(simulation, ranks);
    std::atomic<bool> asked = false;
    int told = 0;
    RunOptions options;
    options.onProgress = [&](const Simulation& s) {
      ++told;
      if (ranks.rank() == 1 && s.stepsDone() == kStep) asked = true;
    };
    const AgreedRun stop(ranks, asked, options);
    EXPECT_EQ(runSimulation(simulation, {}, options), RunEnd::kInterrupted);
    EXPECT_GT(told, kStep);
  });
  for (const auto& simulation : simulations) EXPECT_EQ(simulation->stepsDone(), kStep + 1);
}

TEST_F(JoinRanks, OneThatFailsInAStepEndsAllWithItsError) {
  constexpr int kRanks = 4;
  std::vector<std::unique_ptr<CpuDevice>> devices;
  std::vector<std::unique_ptr<Simulation>> simulations;
  for (int rank = 0; rank < kRanks; ++rank) {
    devices.push_back(std::make_unique<CpuDevice>(1));
    simulations.push_back(simulationOf(
        R"("c": {"type": "Counter", "params": {"fails_at": 12, "fails_on": 2}})", *devices.back()));
  }
  const Error error = errorOf([&] {
    runOnThreads(kRanks, [&](Communicator& ranks) {
      Simulation& simulation = *simulations[std::size_t(ranks.rank())];
      joinRanks(simulation, ranks);
      const std::atomic<bool> never = false;
      RunOptions options;
      const AgreedRun stop(ranks, never, options);
      runSimulation(simulation, {}, options);
    });
  });
  EXPECT_EQ(error.kind(), ErrorKind::kSimulation);
  EXPECT_CONTAINS(error.what(), "rank 2: boom");
  EXPECT_EQ(error.location().node, "c");
  for (const auto& simulation : simulations) EXPECT_LE(simulation->stepsDone(), 13);
}

}  // namespace
}  // namespace weir
