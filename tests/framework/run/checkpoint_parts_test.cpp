// Checkpoints in parts: every row of every part belongs to one rank, parts that are not what was written are
// refused, and a rank that cannot write leaves all as it was.
#include "framework/run/checkpoint_parts.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>

#include "framework/communication/on_ranks.h"
#include "framework/communication/thread_ranks.h"
#include "framework/run/checkpoints_by_ranks.h"
#include "framework/run/guarded_checkpoint.h"
#include "framework/run/join_ranks.h"
#include "framework/scene/scene_file.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir {
namespace {

namespace fs = std::filesystem;
using test::errorOf;

/// Makes files that hold a number, and keeps what stands in them; fails where it is told to.
class Shelf {
 public:
  std::string failsAt;  // a part of a file's name

  void write(const fs::path& file, const Checkpoint& checkpoint) {
    if (!failsAt.empty() && file.string().find(failsAt) != std::string::npos)
      throw ioError("the disk is full").at({.file = file.string()});
    const std::lock_guard lock(mutex_);
    kept_.push_back(checkpoint);
    std::ofstream(file) << kept_.size() - 1;
  }
  Checkpoint read(const fs::path& file) {
    std::ifstream from(file);
    std::size_t number = 0;
    if (!(from >> number)) throw ioError("there is nothing in it").at({.file = file.string()});
    const std::lock_guard lock(mutex_);
    return kept_.at(number);
  }

 private:
  std::mutex mutex_;
  std::vector<Checkpoint> kept_;
};

class ShelfStore final : public CheckpointStore {
 public:
  explicit ShelfStore(Shelf& shelf) : shelf_(shelf) {}
  std::string_view extension() const override { return ".h5"; }
  void write(const fs::path& file, const Checkpoint& checkpoint) const override {
    shelf_.write(file, checkpoint);
  }
  Checkpoint read(const fs::path& file) const override { return shelf_.read(file); }

 private:
  Shelf& shelf_;
};

TEST(SharedRows, EachBelongsToOneRankInTheOrderOfParts) {
  for (std::size_t parts = 1; parts <= 5; ++parts)
    for (int ranks = 1; ranks <= 5; ++ranks)
      for (const std::int64_t rows : {0, 1, 7, 60}) {
        std::vector<std::int64_t> ends(parts, 0);
        std::int64_t most = 0;
        for (int rank = 0; rank < ranks; ++rank) {
          std::int64_t own = 0;
          for (std::size_t part = 0; part < parts; ++part) {
            const SharedRows shared = SharedRows::of(rows, part, parts, {rank, ranks});
            if (shared.count == 0) continue;
            EXPECT_EQ(shared.first, ends[part]);
            ends[part] += shared.count;
            own += shared.count;
          }
          most = std::max(most, own);
        }
        EXPECT_EQ(ends, std::vector<std::int64_t>(parts, rows));
        if (rows == 60) {
          EXPECT_EQ(most, 60 * static_cast<std::int64_t>(parts) / ranks);
        }
      }
}

class CheckpointPartsTest : public testing::Test {
 protected:
  /// Three parts of 4, 0 and 5 particles, and what names them.
  CheckpointPartsTest() {
    fs::create_directory(folderOfParts(file_));
    CheckpointParts parts;
    int first = 0;
    for (const int count : {4, 0, 5}) {
      Checkpoint part;
      std::vector<int> ids(static_cast<std::size_t>(count));
      std::iota(ids.begin(), ids.end(), first);
      first += count;
      StateWriter(part.state).in("water").put("id", std::span<const int>(ids));
      saveRankOfPart(part.state, static_cast<int>(parts.names.size()));
      parts.names.push_back(nameOfPart(file_, 1, static_cast<int>(parts.names.size())));
      parts.digests.push_back(digestOf(part.state));
      store_.write(fs::path(file_).parent_path() / parts.names.back(), part);
    }
    whole_.state.clear();
    StateWriter(whole_.state).in("water").put("next_id", 9);
    parts.save(whole_.state);
    store_.write(file_, whole_);
  }
  std::string part(const std::string& name) const { return folder_ / ("state.parts/" + name); }
  std::vector<int> idsOf(RankShare share) const {
    Checkpoint checkpoint = store_.read(file_);
    readParts(store_, file_, checkpoint, share);
    int next = 0;
    StateReader(checkpoint.state).in("water").get("next_id", next);
    EXPECT_EQ(next, 9);
    return StateReader(checkpoint.state).in("water").getAll<int>("id");
  }
  void expectRefused(const std::string& what) const {
    const Error error = errorOf([&] { idsOf({}); });
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_EQ(error.location().file, file_);
    EXPECT_CONTAINS(error.what(), what);
  }

  test::TemporaryFolder folder_;
  std::string file_ = folder_ / "state.h5";
  Shelf shelf_;
  ShelfStore store_{shelf_};
  Checkpoint whole_;
};

TEST_F(CheckpointPartsTest, AnyNumberOfRanksReadsEachRowOnce) {
  for (int ranks = 1; ranks <= 7; ++ranks) {
    std::vector<int> all;
    for (int rank = 0; rank < ranks; ++rank)
      for (const int id : idsOf({rank, ranks})) all.push_back(id);
    EXPECT_EQ(all, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8})) << ranks;
  }
}

TEST_F(CheckpointPartsTest, WhatIsNotWhatWasWrittenIsRefusedByName) {
  const std::string name = "the part state.parts/1.rank_2.h5 of the checkpoint ";
  fs::rename(part("1.rank_2.h5"), part("gone"));
  expectRefused(name + "is missing");
  std::ofstream(part("1.rank_2.h5")).flush();
  expectRefused(name + "cannot be read: there is nothing in it");
  fs::remove(part("1.rank_2.h5"));
  fs::copy(part("1.rank_0.h5"), part("1.rank_2.h5"));
  expectRefused(name + "is of another checkpoint");
}

TEST_F(CheckpointPartsTest, ANameThatLeadsOutOfTheFolderIsRefused) {
  for (const std::string name : {"../state.h5", "state.parts/../../x.h5", "/etc/passwd"}) {
    Checkpoint bad;
    CheckpointParts{.names = {name}, .digests = {0}}.save(bad.state);
    store_.write(file_, bad);
    expectRefused("the part " + name + " of the checkpoint is not below the folder of this file");
  }
}

TEST_F(CheckpointPartsTest, PartsInUseStayAndSoDoesWhatIsNone) {
  EXPECT_EQ(nextNumberOfParts(file_), 2);
  for (const char* other :
       {"7.rank_0.h5", "3.rank_11.h5", "notes.txt", "7.rank_0.h5.bak", "x.rank_0.h5", "7.rank_.h5"})
    std::ofstream(part(other)).flush();
  EXPECT_EQ(nextNumberOfParts(file_), 8);
  const std::optional<PartNames> kept = partsInUse(store_, file_);
  ASSERT_TRUE(kept.has_value());
  removeOtherParts(file_, *kept);
  for (const char* stays :
       {"1.rank_0.h5", "1.rank_1.h5", "1.rank_2.h5", "notes.txt", "7.rank_0.h5.bak", "x.rank_0.h5"})
    EXPECT_TRUE(fs::exists(part(stays))) << stays;
  for (const char* goes : {"7.rank_0.h5", "3.rank_11.h5"}) EXPECT_FALSE(fs::exists(part(goes))) << goes;
}

TEST_F(CheckpointPartsTest, WhereTheFileCannotBeReadNobodyKnowsWhatIsInUse) {
  std::ofstream(file_).flush();
  EXPECT_FALSE(partsInUse(store_, file_).has_value());
  fs::remove(file_);
  EXPECT_EQ(partsInUse(store_, file_), PartNames{});
}

/// Has nothing.
class Idle final : public Node, public OnRanks {
 public:
  static constexpr NodeInfo kInfo{"Idle", "Does nothing."};
  const NodeInfo& info() const override { return kInfo; }
  void join(Communicator&) override {}
  void reset(const SetupContext&) override {}
};

class WrittenByRanks : public testing::Test {
 protected:
  static constexpr int kRanks = 3;

  WrittenByRanks() { registry_.addNode<Idle>(); }
  void runOn(int ranks, std::int64_t frames) {
    std::vector<std::unique_ptr<CpuDevice>> devices;
    std::vector<std::unique_ptr<Simulation>> simulations;
    for (int rank = 0; rank < ranks; ++rank) {
      devices.push_back(std::make_unique<CpuDevice>(1));
      std::vector<std::string> ignored;
      auto scene = buildScene(
          parseJson(
              R"({"weir": 1, "world": {"frame_rate": 10, "duration": 1}, "nodes": {"i": {"type": "Idle"}}})",
              "s.json"),
          {"s.json", "", "/"}, registry_, {}, ignored);
      simulations.push_back(std::make_unique<Simulation>(std::move(scene), *devices.back(), log_, registry_));
    }
    runOnThreads(ranks, [&](Communicator& communicator) {
      Simulation& simulation = *simulations[std::size_t(communicator.rank())];
      joinRanks(simulation, communicator);
      CheckpointsByRanks checkpoints(
          Checkpoints(file_, CheckpointInterval::parse("1"), std::make_unique<ShelfStore>(shelf_)),
          communicator);
      const std::atomic<bool> never = false;
      RunOptions options;
      options.lastFrame = frames;
      options.checkpointsByRanks = &checkpoints;
      const AgreedRun agreed(communicator, never, options);
      runSimulation(simulation, {}, options);
    });
  }
  /// By name from the folder.
  std::set<std::string> files() const {
    std::set<std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      if (entry.is_regular_file()) all.insert(entry.path().lexically_relative(folder_.path()).string());
    return all;
  }
  std::int64_t frameOf(const std::string& name) {
    const ShelfStore store(shelf_);
    Checkpoint checkpoint = store.read(folder_ / name);
    readParts(store, folder_ / name, checkpoint);
    std::int64_t frame = 0;
    StateReader(checkpoint.state).in("clock").get("frame", frame);
    return frame;
  }

  test::TemporaryFolder folder_;
  std::string file_ = folder_ / "c.h5";
  Shelf shelf_;
  Registry registry_;
  Log log_;
};

TEST_F(WrittenByRanks, ThePartsOfTwoCheckpointsStay) {
  runOn(2, 4);
  const std::set<std::string> four{"c.h5", "c.previous.h5"}, parts = files();
  EXPECT_EQ(parts, (std::set<std::string>{"c.h5", "c.parts/3.rank_0.h5", "c.parts/3.rank_1.h5",
                                          "c.parts/4.rank_0.h5", "c.parts/4.rank_1.h5", "c.previous.h5"}));
  EXPECT_EQ(frameOf("c.h5"), 4);
  EXPECT_EQ(frameOf("c.previous.h5"), 3);
  // One rank makes one file, and those parts go with the last checkpoint that has them.
  runOn(1, 1);
  EXPECT_EQ(frameOf("c.previous.h5"), 4);
  runOn(1, 1);
  EXPECT_EQ(files(), four);
  EXPECT_FALSE(fs::exists(folder_ / "c.parts"));
}

TEST_F(WrittenByRanks, WhereOneCannotBeWrittenTheLastTwoStayAndNothingElse) {
  for (const std::string failing : {"rank_0", "rank_2", ".part"}) {
    shelf_.failsAt.clear();
    runOn(kRanks, 2);
    const std::set<std::string> before = files();
    EXPECT_EQ(before.size(), 2u + 2 * kRanks);
    shelf_.failsAt = failing == ".part" ? "c.h5." : failing;
    const Error error = errorOf([&] { runOn(kRanks, 2); });
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_CONTAINS(error.what(), "the disk is full");
    EXPECT_CONTAINS(error.what(), failing == "rank_2" ? "rank 2: " : "rank 0: ");
    EXPECT_EQ(files(), before) << failing;
    EXPECT_EQ(frameOf("c.h5"), 2);
    EXPECT_EQ(frameOf("c.previous.h5"), 1);
  }
}

TEST_F(WrittenByRanks, WhatAnEndedRunLeftGoes) {
  runOn(2, 1);
  for (const char* left : {"c.parts/9.rank_0.h5", "c.parts/8.rank_5.h5"})
    std::ofstream(folder_ / left) << "half";
  runOn(2, 1);
  EXPECT_EQ(files(),
            (std::set<std::string>{"c.h5", "c.parts/1.rank_0.h5", "c.parts/1.rank_1.h5",
                                   "c.parts/10.rank_0.h5", "c.parts/10.rank_1.h5", "c.previous.h5"}));
}

}  // namespace
}  // namespace weir
