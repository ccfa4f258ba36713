// --series: a line for every frame of a run, and what becomes of them where it fails or is resumed.
#include "framework/run/series.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "framework/scene/scene_file.h"
#include "tests/framework/run/bomb_run.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir {
namespace {

using Series = test::BombRun;

std::vector<Value> linesOf(const std::string& file) {
  std::istringstream text(test::readFile(file));
  std::vector<Value> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(parseJson(line, file));
  return lines;
}

TEST_F(Series, HasALineForEveryFrame) {
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

TEST_F(Series, OfAFailedRunHasTheFramesThatWereReached) {
  const test::TemporaryFolder folder;
  const auto s = simulation(R"({"fails_at": 5})");
  SeriesOutput series(folder / "s.jsonl");
  Observer* observers[] = {&series};
  test::errorOf([&] { runSimulation(*s, observers); });
  EXPECT_EQ(linesOf(folder / "s.jsonl").size(), 3u);
}

TEST_F(Series, GrowsWhileTheRunGoesOn) {
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
class ResumedSeries : public test::BombRun {
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

TEST_F(Series, ThatCannotBeWrittenStopsTheRunBeforeItStarts) {
  const test::TemporaryFolder folder;
  const auto s = simulation();
  SeriesOutput series(folder / "none/s.jsonl");
  Observer* observers[] = {&series};
  EXPECT_EQ(test::errorOf([&] { runSimulation(*s, observers); }).kind(), ErrorKind::kIo);
  EXPECT_EQ(s->stepsDone(), 0);
}

}  // namespace
}  // namespace weir
