// Outputs that write their frames beside the simulation: order, errors, checkpoints, and what waits for what.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "framework/run/checkpoint.h"
#include "framework/run/run.h"
#include "tests/framework/run/bomb_run.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir {
namespace {

using test::Recorder;
using WrittenBeside = test::BombRun;

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

TEST_F(WrittenBeside, FramesAreWrittenInOrderBesideTheSimulation) {
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

TEST_F(WrittenBeside, ASlowOutputHoldsTheSimulationBack) {
  const auto s = simulation("{}", R"({"dt": 0.005, "frame_rate": 100, "duration": 0.2})");
  Writer* self = nullptr;
  Writer writer([&](std::int64_t frame) {
    EXPECT_TRUE(frame != 0 || waitUntil([&] { return self->captured == 3; })) << "it does not go on";
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  });
  self = &writer;
  Observer* observers[] = {&writer};
  EXPECT_EQ(runSimulation(*s, observers), RunEnd::kFinished);
  EXPECT_EQ(writer.written.size(), 21u);
  EXPECT_EQ(writer.made, 3) << "the memory of written frames is used again";
  const OutputTime& time = s->outputTimes()[0];
  EXPECT_GE(time.write, 21 * 0.002);
  EXPECT_GT(time.wait, 0);
}

TEST_F(WrittenBeside, AFailedWriteEndsTheRunAtTheNextStep) {
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

TEST_F(WrittenBeside, AFailedWriteOfTheLastFrameIsAnErrorOfTheRun) {
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

TEST_F(WrittenBeside, WhatWasCapturedBeforeAFailureIsWritten) {
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

/// Sets what it points to at the end of its thread.
struct ThreadEnd {
  std::atomic<bool>* ended = nullptr;
  ~ThreadEnd() {
    if (ended != nullptr) *ended = true;
  }
};

TEST_F(WrittenBeside, TheFirstErrorIsTheOneThatIsTold) {
  const auto s = simulation();
  std::atomic<bool> firstEnded = false;
  Writer first([&](std::int64_t) {
    thread_local ThreadEnd end;
    end.ended = &firstEnded;
    throw ioError("first");
  });
  Writer second([&](std::int64_t) {
    EXPECT_TRUE(waitUntil([&] { return firstEnded.load(); }));
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

TEST_F(WrittenBeside, OutputsWriteWhatTheyCapturedBeforeACheckpointIsMade) {
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

TEST_F(WrittenBeside, ObserversWithAStateResumeAndOthersBegin) {
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

TEST_F(WrittenBeside, AFailedWriteKeepsTheCheckpointFromBeingMade) {
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

}  // namespace
}  // namespace weir
