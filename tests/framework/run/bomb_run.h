// Runs of a scene with one node, which fails at a step if it is told to.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "framework/run/run.h"
#include "framework/scene/scene_file.h"

namespace weir::test {

/// Fails at a step, if told to.
class Bomb final : public Node {
 public:
  static constexpr NodeInfo kInfo{"Bomb", "Fails at a step."};
  const NodeInfo& info() const override { return kInfo; }
  Param<int> failsAt{*this, "fails_at", -1, {.doc = "The step that fails."}};
  void reset(const SetupContext&) override { times.clear(); }
  void step(const StepContext& context) override {
    if (context.index == failsAt) throw simulationError("boom");
    times.push_back(context.time);
  }
  void report(NodeReport& report) override {
    report.statistics["steps_seen"] = static_cast<std::int64_t>(times.size());
  }
  std::vector<double> times;
};

class Recorder final : public Observer {
 public:
  explicit Recorder(std::string failsIn = "") : failsIn_(std::move(failsIn)) {}
  std::string name() const override { return "recorder"; }
  void begin(Simulation&) override { record("begin"); }
  std::unique_ptr<Snapshot> capture(Simulation& s, std::unique_ptr<Snapshot>) override {
    record("frame " + std::to_string(s.frame()));
    return nullptr;
  }
  void end(Simulation&, RunEnd how) override { record("end " + std::string(nameOf(how))); }
  std::vector<std::string> calls;

 private:
  void record(const std::string& call) {
    if (call == failsIn_) throw ioError("observer failed in " + call);
    calls.push_back(call);
  }
  std::string failsIn_;
};

class BombRun : public testing::Test {
 protected:
  BombRun() { registry_.addNode<Bomb>(); }

  static constexpr const char* kThreeFrames = R"({"dt": 0.005, "frame_rate": 100, "duration": 0.03})";

  std::unique_ptr<Simulation> simulation(const std::string& parameters = "{}",
                                         const std::string& world = kThreeFrames) {
    const std::string text = R"({"weir": 1, "world": )" + world +
                             R"(, "nodes": {"bomb": {"type": "Bomb", "params": )" + parameters + "}}}";
    std::vector<std::string> warnings;
    auto scene = buildScene(parseJson(text, "s.json"), {"s.json", "", "/"}, registry_, {}, warnings);
    return std::make_unique<Simulation>(std::move(scene), *device_, log_, registry_);
  }

  using Calls = std::vector<std::string>;
  std::unique_ptr<Device> device_ = openDevice("cpu");
  Log log_;
  Registry registry_;
};

}  // namespace weir::test
