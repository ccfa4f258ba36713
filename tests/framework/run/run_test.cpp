// The frame loop: what observers see and write and when, also when something fails or the run is interrupted.
#include "framework/run/run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "framework/run/series.h"
#include "framework/run/statistics.h"
#include "framework/scene/scene_file.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir {
namespace {

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

class Run : public testing::Test {
 protected:
  Run() { registry_.addNode<Bomb>(); }

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

TEST_F(Run, ObserversSeeEveryFrame) {
  const auto s = simulation();
  Recorder recorder;
  Observer* observers[] = {&recorder};
  EXPECT_EQ(runSimulation(*s, observers), RunEnd::kFinished);
  EXPECT_EQ(recorder.calls, (Calls{"begin", "frame 0", "frame 1", "frame 2", "frame 3", "end finished"}));
  const auto& times = static_cast<Bomb&>(*s->scene().graph.find("bomb")).times;
  ASSERT_EQ(times.size(), 6u);
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(times[k], 0.005 * double(k), 1e-15);
}

TEST_F(Run, EndsAtTheLastFrameThatIsAskedFor) {
  const auto s = simulation();
  Recorder recorder;
  Observer* observers[] = {&recorder};
  RunOptions options;
  options.lastFrame = 1;
  EXPECT_EQ(runSimulation(*s, observers, options), RunEnd::kFinished);
  EXPECT_EQ(recorder.calls, (Calls{"begin", "frame 0", "frame 1", "end finished"}));
  EXPECT_EQ(s->stepsDone(), 2);
}

TEST_F(Run, AnInterruptedRunClosesItsObservers) {
  const auto s = simulation();
  Recorder recorder;
  Observer* observers[] = {&recorder};
  std::atomic<bool> stop = false;
  RunOptions options;
  options.stop = &stop;
  options.onProgress = [&](const Simulation& now) { stop = now.stepsDone() == 3; };
  EXPECT_EQ(runSimulation(*s, observers, options), RunEnd::kInterrupted);
  EXPECT_EQ(recorder.calls, (Calls{"begin", "frame 0", "frame 1", "end interrupted"}));
}

TEST_F(Run, AFailingNodeIsNamedAndObserversAreClosed) {
  const auto s = simulation(R"({"fails_at": 2})");
  Recorder recorder;
  Observer* observers[] = {&recorder};
  const Error e = test::errorOf([&] { runSimulation(*s, observers); });
  EXPECT_EQ(e.location().node, "bomb");
  EXPECT_CONTAINS(e.what(), "boom");
  EXPECT_EQ(recorder.calls, (Calls{"begin", "frame 0", "frame 1", "end failed"}));
}

TEST_F(Run, AFailingObserverDoesNotKeepOthersFromTheirEnd) {
  for (const char* where : {"frame 1", "end finished"}) {
    const auto s = simulation();
    Recorder bad(where), good;
    Observer* observers[] = {&bad, &good};
    EXPECT_EQ(test::errorOf([&] { runSimulation(*s, observers); }).kind(), ErrorKind::kIo);
    EXPECT_TRUE(good.calls.back().starts_with("end")) << where;
  }
}

TEST_F(Run, AnObserverThatCannotBeginStopsTheRunBeforeItStarts) {
  const auto s = simulation();
  Recorder good, bad("begin"), never;
  Observer* observers[] = {&good, &bad, &never};
  test::errorOf([&] { runSimulation(*s, observers); });
  EXPECT_EQ(good.calls, (Calls{"begin", "end failed"}));
  EXPECT_TRUE(never.calls.empty());
  EXPECT_EQ(s->stepsDone(), 0);
}

std::vector<Value> linesOf(const std::string& file) {
  std::istringstream text(test::readFile(file));
  std::vector<Value> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(parseJson(line, file));
  return lines;
}

TEST_F(Run, ASeriesHasALineForEveryFrame) {
  const test::TemporaryFolder folder;
  const auto s = simulation();
  SeriesOutput series(folder / "s.jsonl");
  Observer* observers[] = {&series};
  runSimulation(*s, observers);
  const std::vector<Value> lines = linesOf(folder / "s.jsonl");
  ASSERT_EQ(lines.size(), 4u);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const auto steps = static_cast<std::int64_t>(2 * k);
    EXPECT_EQ(lines[k].find("frame")->asInt(), static_cast<std::int64_t>(k));
    EXPECT_NEAR(lines[k].find("time")->asDouble(), 0.01 * double(k), 1e-15);
    EXPECT_EQ(lines[k].find("steps")->asInt(), steps);
    EXPECT_EQ(lines[k].find("nodes")->find("bomb")->find("steps_seen")->asInt(), steps);
  }
}

TEST_F(Run, ASeriesOfAFailedRunHasTheFramesThatWereReached) {
  const test::TemporaryFolder folder;
  const auto s = simulation(R"({"fails_at": 5})");
  SeriesOutput series(folder / "s.jsonl");
  Observer* observers[] = {&series};
  test::errorOf([&] { runSimulation(*s, observers); });
  EXPECT_EQ(linesOf(folder / "s.jsonl").size(), 3u);
}

TEST_F(Run, ASeriesGrowsWhileTheRunGoesOn) {
  const test::TemporaryFolder folder;
  folder.write("s.jsonl", "an older one");
  const auto s = simulation();
  SeriesOutput series(folder / "s.jsonl");
  std::vector<std::size_t> lines;
  Observer* observers[] = {&series};
  RunOptions options;
  options.onProgress = [&](const Simulation& now) {
    if (now.atFrame()) lines.push_back(linesOf(folder / "s.jsonl").size());
  };
  runSimulation(*s, observers, options);
  EXPECT_GE(lines.size(), 3u);
  for (std::size_t k = 0; k < lines.size(); ++k) EXPECT_GE(lines[k] + 1, k) << "at frame " << k;
}

/// Runs the first frames, saves the series as a checkpoint does, and goes on to the end elsewhere.
class ResumedSeries : public Run {
 protected:
  /// Frames 0 and 1, and frame 2, which the checkpoint does not have.
  void runFirst(const std::string& file) {
    const auto s = simulation();
    SeriesOutput series(file);
    series.begin(*s);
    s->reset();
    const std::atomic<bool> stop = false;
    for (int frame = 0; frame < 3; ++frame) {
      series.capture(*s, nullptr);
      if (frame == 1) series.save(StateWriter(saved_));
      if (frame == 1) s->save(StateWriter(simulation_));
      s->advanceFrame(stop);
    }
    series.end(*s, RunEnd::kInterrupted);
  }

  void goOn(const std::string& file) {
    const auto s = simulation();
    SeriesOutput series(file);
    s->resume(StateReader(simulation_));
    series.resume(*s, StateReader(saved_));
    const std::atomic<bool> stop = false;
    while (s->advanceFrame(stop)) series.capture(*s, nullptr);
    series.end(*s, RunEnd::kFinished);
  }

  StateArrays saved_, simulation_;
  test::TemporaryFolder folder_;
};

TEST_F(ResumedSeries, GoesOnBehindTheFramesOfTheCheckpoint) {
  for (const char* name : {"s.jsonl", "s.csv"}) {
    saved_.clear(), simulation_.clear();
    runFirst(folder_ / name);
    goOn(folder_ / name);
    std::istringstream text(test::readFile(folder_ / name));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    const bool table = std::string(name) == "s.csv";
    ASSERT_EQ(lines.size(), table ? 5u : 4u) << name;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::string begin = table ? std::to_string(k) + "," : R"({ "frame": )" + std::to_string(k) + ",";
      EXPECT_TRUE(lines[k + (table ? 1 : 0)].starts_with(begin)) << lines[k];
    }
    if (!table) continue;
    for (const std::string& line : lines)
      EXPECT_EQ(std::count(line.begin(), line.end(), ','), std::count(lines[0].begin(), lines[0].end(), ','));
    EXPECT_TRUE(lines[0].ends_with(",ms_per_step"));
    EXPECT_TRUE(lines[1].ends_with(",")) << "there was no step before frame 0";
    EXPECT_FALSE(lines[3].ends_with(","));
  }
}

TEST_F(ResumedSeries, IsRefusedWhereTheFileIsNoLongerWhatItWas) {
  const std::string file = folder_ / "s.jsonl";
  runFirst(file);
  const std::string whole = test::readFile(file);
  const auto refused = [&](const std::string& text) {
    folder_.write("s.jsonl", text);
    const Error e = test::errorOf([&] { goOn(file); });
    EXPECT_EQ(e.kind(), ErrorKind::kIo);
    EXPECT_CONTAINS(e.what(), file);
    EXPECT_EQ(test::readFile(file), text) << "nothing is changed";
  };
  std::string other = whole;
  other[10] ^= 1;
  refused(other);
  refused(whole.substr(0, 20));
  refused("");
  std::filesystem::remove(file);
  EXPECT_CONTAINS(test::errorOf([&] { goOn(file); }).what(), file);
  folder_.write("s.jsonl", whole);
  goOn(file);
  EXPECT_EQ(linesOf(file).size(), 4u);
}

TEST_F(Run, ASeriesThatCannotBeWrittenStopsTheRunBeforeItStarts) {
  const test::TemporaryFolder folder;
  const auto s = simulation();
  SeriesOutput series(folder / "none/s.jsonl");
  Observer* observers[] = {&series};
  EXPECT_EQ(test::errorOf([&] { runSimulation(*s, observers); }).kind(), ErrorKind::kIo);
  EXPECT_EQ(s->stepsDone(), 0);
}

/// Captures the numbers of frames and writes them to a list.
class Writer : public Observer {
 public:
  struct Frame final : Snapshot {
    std::int64_t frame = 0;
  };
  explicit Writer(std::function<void(std::int64_t frame)> beforeWrite = {})
      : beforeWrite_(std::move(beforeWrite)) {}

  std::string name() const override { return "writer"; }
  void begin(Simulation&) override {}
  std::unique_ptr<Snapshot> capture(Simulation& s, std::unique_ptr<Snapshot> used) override {
    // One that is being written, and one that waits; this one comes behind them.
    EXPECT_LE(captured - static_cast<std::int64_t>(writtenCount), 2);
    made += used == nullptr ? 1 : 0;
    if (!used) used = std::make_unique<Frame>();
    static_cast<Frame&>(*used).frame = s.frame();
    ++captured;
    return used;
  }
  void write(Snapshot& snapshot) override {
    EXPECT_NE(std::this_thread::get_id(), simulationThread_);
    const std::int64_t frame = static_cast<Frame&>(snapshot).frame;
    if (beforeWrite_) beforeWrite_(frame);
    written.push_back(frame);
    ++writtenCount;
  }
  void end(Simulation&, RunEnd how) override { ends.push_back(how); }

  std::atomic<std::int64_t> captured = 0, writtenCount = 0;
  int made = 0;  // snapshots
  std::vector<std::int64_t> written;
  std::vector<RunEnd> ends;

 private:
  std::function<void(std::int64_t)> beforeWrite_;
  const std::thread::id simulationThread_ = std::this_thread::get_id();
};

using Frames = std::vector<std::int64_t>;
using Ends = std::vector<RunEnd>;

/// False if that takes too long.
bool waitUntil(const std::function<bool()>& condition) {
  const auto latest = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > latest) return false;
    std::this_thread::yield();
  }
  return true;
}

TEST_F(Run, FramesAreWrittenInOrderBesideTheSimulation) {
  const auto s = simulation();
  Writer* self = nullptr;
  Writer writer([&](std::int64_t frame) {
    EXPECT_TRUE(frame != 0 || waitUntil([&] { return self->captured == 3; })) << "it does not go on";
  });
  self = &writer;
  Observer* observers[] = {&writer};
  EXPECT_EQ(runSimulation(*s, observers), RunEnd::kFinished);
  EXPECT_EQ(writer.written, (Frames{0, 1, 2, 3}));
  EXPECT_EQ(writer.ends, Ends{RunEnd::kFinished});
  ASSERT_EQ(s->outputTimes().size(), 1u);
  EXPECT_EQ(s->outputTimes()[0].name, "writer");
}

TEST_F(Run, ASlowOutputHoldsTheSimulationBack) {
  const auto s = simulation("{}", R"({"dt": 0.005, "frame_rate": 100, "duration": 0.2})");
  Writer writer([&](std::int64_t) { std::this_thread::sleep_for(std::chrono::milliseconds(2)); });
  Observer* observers[] = {&writer};
  EXPECT_EQ(runSimulation(*s, observers), RunEnd::kFinished);
  EXPECT_EQ(writer.written.size(), 21u);
  EXPECT_EQ(writer.made, 3) << "the memory of written frames is used again";
  const OutputTime& time = s->outputTimes()[0];
  EXPECT_GE(time.write, 21 * 0.002);
  EXPECT_GT(time.wait, 0);
}

TEST_F(Run, AFailedWriteEndsTheRunAtTheNextStep) {
  const auto s = simulation("{}", R"({"dt": 1e-7, "frame_rate": 1, "duration": 1})");
  Writer bad([](std::int64_t) { throw ioError("the disk is full"); }), good;
  Observer* observers[] = {&good, &bad};
  const Error e = test::errorOf([&] { runSimulation(*s, observers); });
  EXPECT_EQ(e.kind(), ErrorKind::kIo);
  EXPECT_EQ(e.message(), "the disk is full");
  EXPECT_LT(s->stepsDone(), 10'000'000);
  EXPECT_EQ(s->frame(), 0);
  EXPECT_EQ(good.written, Frames{0});
  EXPECT_EQ(good.ends, Ends{RunEnd::kFailed});
  EXPECT_EQ(bad.ends, Ends{RunEnd::kFailed});
}

TEST_F(Run, AFailedWriteOfTheLastFrameIsAnErrorOfTheRun) {
  const auto s = simulation();
  Writer bad([](std::int64_t frame) {
    if (frame == 3) throw ioError("the disk is full");
  });
  Writer good;
  Observer* observers[] = {&bad, &good};
  EXPECT_EQ(test::errorOf([&] { runSimulation(*s, observers); }).message(), "the disk is full");
  EXPECT_EQ(bad.written, (Frames{0, 1, 2}));
  EXPECT_EQ(good.written, (Frames{0, 1, 2, 3}));
  EXPECT_EQ(good.ends, Ends{RunEnd::kFailed});
}

TEST_F(Run, WhatWasCapturedBeforeAFailureIsWritten) {
  const auto s = simulation(R"({"fails_at": 5})");
  std::atomic<bool> failed = false;
  Writer writer(
      [&](std::int64_t frame) { EXPECT_TRUE(frame != 1 || waitUntil([&] { return failed.load(); })); });
  Observer* observers[] = {&writer};
  RunOptions options;
  options.onProgress = [&](const Simulation& now) { failed = now.stepsDone() == 5; };
  EXPECT_CONTAINS(test::errorOf([&] { runSimulation(*s, observers, options); }).what(), "boom");
  EXPECT_EQ(writer.written, (Frames{0, 1, 2}));
}

TEST_F(Run, TheFirstErrorIsTheOneThatIsTold) {
  const auto s = simulation();
  std::atomic<bool> firstFailed = false;
  Writer first([&](std::int64_t) {
    firstFailed = true;
    throw ioError("first");
  });
  Writer second([&](std::int64_t) {
    waitUntil([&] { return firstFailed.load(); });
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    throw ioError("second");
  });
  Observer* observers[] = {&second, &first};
  EXPECT_EQ(test::errorOf([&] { runSimulation(*s, observers); }).message(), "first");
}

/// A writer that has a state, and keeps what was written whenever it is saved.
class Saver final : public Writer {
 public:
  using Writer::Writer;
  std::string_view stateName() const override { return "saver"; }
  void save(const StateWriter& to) override {
    EXPECT_EQ(writtenCount, captured) << "frames are still being written";
    saves.push_back(written);
    to.put("frames", captured.load());
  }
  void resume(Simulation&, const StateReader& from) override {
    std::int64_t frames = 0;
    from.get("frames", frames);
    resumedAt = frames;
  }
  std::vector<Frames> saves;
  std::optional<std::int64_t> resumedAt;
};

/// Makes empty files and keeps the last checkpoint.
class Store final : public CheckpointStore {
 public:
  explicit Store(std::optional<Checkpoint>& last) : last_(last) {}
  std::string_view extension() const override { return ".h5"; }
  void write(const std::filesystem::path& file, const Checkpoint& checkpoint) const override {
    std::ofstream(file).flush();
    last_ = checkpoint;
  }
  Checkpoint read(const std::filesystem::path&) const override { return last_.value(); }

 private:
  std::optional<Checkpoint>& last_;
};

TEST_F(Run, OutputsWriteWhatTheyCapturedBeforeACheckpointIsMade) {
  const test::TemporaryFolder folder;
  const auto s = simulation();
  Saver saver([](std::int64_t) { std::this_thread::sleep_for(std::chrono::milliseconds(20)); });
  Observer* observers[] = {&saver};
  std::optional<Checkpoint> last;
  Checkpoints checkpoints(folder / "c.h5", CheckpointInterval::parse("1"), std::make_unique<Store>(last));
  RunOptions options;
  options.checkpoints = &checkpoints;
  EXPECT_EQ(runSimulation(*s, observers, options), RunEnd::kFinished);
  ASSERT_FALSE(saver.saves.empty());
  EXPECT_EQ(saver.saves.back(), (Frames{0, 1, 2, 3}));
  EXPECT_GT(s->outputTimes()[0].wait, 0);
  ASSERT_TRUE(last.has_value());
  EXPECT_EQ(saver.written, (Frames{0, 1, 2, 3})) << "the run goes on after a checkpoint";
}

TEST_F(Run, ObserversWithAStateResumeAndOthersBegin) {
  const test::TemporaryFolder folder;
  std::optional<Checkpoint> last;
  {
    const auto s = simulation();
    Saver saver;
    Observer* observers[] = {&saver};
    Checkpoints checkpoints(folder / "c.h5", CheckpointInterval::parse("1"), std::make_unique<Store>(last));
    RunOptions options;
    options.lastFrame = 1;
    options.checkpoints = &checkpoints;
    runSimulation(*s, observers, options);
  }
  ASSERT_TRUE(last.has_value());
  const auto s = simulation();
  Saver saver;
  Recorder recorder;
  Observer* observers[] = {&saver, &recorder};
  RunOptions options;
  options.resume = &last->state;
  EXPECT_EQ(runSimulation(*s, observers, options), RunEnd::kFinished);
  EXPECT_EQ(saver.resumedAt, 2) << "frames 0 and 1";
  EXPECT_EQ(saver.written, (Frames{2, 3}));
  EXPECT_EQ(recorder.calls, (Calls{"begin", "frame 2", "frame 3", "end finished"}));
}

TEST_F(Run, AFailedWriteKeepsTheCheckpointFromBeingMade) {
  const test::TemporaryFolder folder;
  const auto s = simulation();
  Saver bad([](std::int64_t frame) {
    if (frame == 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    throw ioError("the disk is full");
  });
  Saver good;
  Observer* observers[] = {&good, &bad};
  std::optional<Checkpoint> last;
  Checkpoints checkpoints(folder / "c.h5", CheckpointInterval::parse("1"), std::make_unique<Store>(last));
  RunOptions options;
  options.checkpoints = &checkpoints;
  EXPECT_EQ(test::errorOf([&] { runSimulation(*s, observers, options); }).message(), "the disk is full");
  EXPECT_FALSE(last.has_value());
  EXPECT_TRUE(good.saves.empty());
  EXPECT_EQ(good.written, (Frames{0, 1}));
}

TEST_F(Run, ProceedsFromWhereTheSimulationIs) {
  const auto s = simulation();
  s->reset();
  const std::atomic<bool> never = false;
  s->advanceFrame(never);
  Recorder recorder;
  Observer* observers[] = {&recorder};
  RunOptions options;
  options.proceed = true;
  options.lastFrame = 2;
  EXPECT_EQ(runSimulation(*s, observers, options), RunEnd::kFinished);
  EXPECT_EQ(recorder.calls, (Calls{"begin", "frame 1", "frame 2", "end finished"}));
  EXPECT_EQ(s->stepsDone(), 4);
}

TEST_F(Run, MayBecomeLongerOrShorterButNotThanItIs) {
  const auto s = simulation();
  s->reset();
  const std::atomic<bool> never = false;
  while (s->advanceFrame(never)) {
  }
  EXPECT_EQ(s->frame(), 3);
  s->setDuration(0.05);
  while (s->advanceFrame(never)) {
  }
  EXPECT_EQ(s->frame(), 5);
  EXPECT_DOUBLE_EQ(s->time(), 0.05);
  EXPECT_EQ(test::errorOf([&] { s->setDuration(0.04); }).kind(), ErrorKind::kUsage);
  s->setDuration(0.057);
  s->finishRest(never);
  EXPECT_NEAR(s->time(), 0.057, 1e-12);
  // The steps of the rest are not those of a frame.
  EXPECT_EQ(test::errorOf([&] { s->setDuration(0.07); }).kind(), ErrorKind::kUsage);
}

TEST_F(Run, AResetTakesTheWorldAsItIs) {
  const auto s = simulation();
  s->scene().world.dt.set(0.001);
  s->reset();
  s->step();
  EXPECT_DOUBLE_EQ(s->time(), 0.001);
}

TEST_F(Run, GivesTheSceneToAnotherSimulation) {
  auto s = simulation();
  s->reset();
  s->step();
  std::unique_ptr<Scene> scene = s->release();
  s.reset();
  Simulation other(std::move(scene), *device_, log_, registry_);
  other.reset();
  EXPECT_EQ(other.time(), 0);
}

TEST(TimeSummary, PercentilesAreElements) {
  const std::vector<double> times{4, 1, 3, 2};
  const TimeSummary s = summarize(times);
  EXPECT_EQ(s.median, 2);
  EXPECT_EQ(s.p95, 4);
  EXPECT_EQ(s.max, 4);
  EXPECT_EQ(s.mean, 2.5);
  EXPECT_EQ(summarize({}).p95, 0);
}

}  // namespace
}  // namespace weir
