// --checkpoint on several ranks: a part of each rank, and one file that names them.
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <set>

#include "framework/run/checkpoint_parts.h"
#include "framework/run/progress.h"
#include "plugins/vtkhdf/checkpoint_file.h"
#include "tests/plugins/outputs/meanwhile.h"
#include "tests/plugins/outputs/ranks_run.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/small_disk.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEnd = "12";  // a frame, past the last one that is saved

class CheckpointByRanks : public RanksTest {
 protected:
  CheckpointByRanks() { scene_ = folder_.write("scene.json", kStateful); }

  std::vector<std::string> arguments(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"run", scene_,         "--quiet", "--device",           where_, "--threads",
                                 "1",   "--checkpoint", file_,     "--checkpoint-every", "4"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Saves frames 4 and 8.
  void save(const std::vector<std::string>& more) const {
    const ChildResult result = runWeir(arguments(with(more, {"--frames", "9"})));
    EXPECT_EQ(result.code, 0) << result.err;
  }
  static std::vector<std::string> with(std::vector<std::string> all, const std::vector<std::string>& more) {
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  std::string part(const std::string& name) const { return folder_ / ("run.parts/" + name); }
  std::set<std::string> parts() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_ / "run.parts"))
      names.insert(entry.path().filename().string());
    return names;
  }
  /// All particles, whoever owns them.
  static StateArrays stateOf(const std::string& file) {
    const Hdf5CheckpointStore store;
    Checkpoint checkpoint = store.read(file);
    readParts(store, file, checkpoint);
    return checkpoint.state;
  }
  /// Of particles, which is the same for any number of ranks.
  static void expectSameParticles(const std::string& one, const std::string& other) {
    const StateArrays left = stateOf(one), right = stateOf(other);
    int compared = 0;
    for (const auto& [path, array] : left) {
      if (!path.starts_with("nodes/water/particles/") || path.ends_with("/ranks")) continue;
      ASSERT_TRUE(right.contains(path)) << path;
      EXPECT_TRUE(right.at(path).data == array.data) << path;
      ++compared;
    }
    EXPECT_GE(compared, 4);
  }
  /// What the run makes of it from here on, with any ranks: a text of all numbers at a frame.
  std::string endOf(const std::vector<std::string>& more, int processes = 1, const char* frame = kEnd) const {
    const std::string to = folder_ / "end.json";
    const std::vector<std::string> all = with(
        {"run", scene_, "--quiet", "--device", where_, "--threads", "1", "--stats", to, "--frames", frame},
        more);
    const ChildResult result = processes == 1 ? runWeir(all) : runByMpi(processes, all);
    EXPECT_EQ(result.code, 0) << result.err;
    return writeJson(*parseJson(readFile(to), to).find("nodes"));
  }
  void expectBroken(const std::string& problem) const {
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"info", file_},
          {"run", scene_, "--quiet", "--resume", file_},
          {"run", scene_, "--quiet", "--resume", file_, "--ranks", "2"}}) {
      const ChildResult result = runWeir(command);
      EXPECT_EQ(result.code, 5) << command.front();
      EXPECT_CONTAINS(result.err, file_);
      EXPECT_CONTAINS(result.err, problem);
    }
  }
  void expectSameEndOnAnyNumber() const {
    const std::string whole = endOf({"--ranks", "1"});
    for (const std::string from : {"1", "2", "3"}) {
      save({"--ranks", from});
      EXPECT_EQ(fs::exists(folder_ / "run.parts"), from != "1");
      for (const std::string to : {"1", "2", "3"})
        EXPECT_EQ(endOf({"--ranks", to, "--resume", file_}), whole) << "from " << from << " to " << to;
    }
  }

  std::string file_ = folder_ / "run.h5", where_ = "cpu";
};

TEST_F(CheckpointByRanks, EachWritesWhatItOwnsAndNothingIsGathered) {
  save({"--ranks", "3", "--stats", folder_ / "s.json"});
  EXPECT_EQ(parts(), (std::set<std::string>{"1.rank_0.h5", "1.rank_1.h5", "1.rank_2.h5", "2.rank_0.h5",
                                            "2.rank_1.h5", "2.rank_2.h5"}));
  const Value water = *parseJson(readFile(folder_ / "s.json"), "s.json").find("ranks")->find("water");
  EXPECT_EQ(water.find("gathered")->asInt(), 0);
  EXPECT_EQ(water.find("step_ms")->find("gathering")->find("max")->asDouble(), 0);
  const StateArrays named = Hdf5CheckpointStore().read(file_).state;
  EXPECT_FALSE(named.contains("nodes/water/particles/position"));
  const std::int64_t all = stateOf(file_).at("nodes/water/particles/position").rows;
  EXPECT_GT(all, 500);
  for (const char* name : {"2.rank_0.h5", "2.rank_1.h5", "2.rank_2.h5"}) {
    const StateArrays own = Hdf5CheckpointStore().read(part(name)).state;
    EXPECT_GT(own.at("nodes/water/particles/position").rows, 0) << name;
    EXPECT_LT(own.at("nodes/water/particles/position").rows, all / 2) << name;
  }
}

TEST_F(CheckpointByRanks, IsTheSameWhoeverWroteIt) {
  const std::string one = folder_ / "one.h5";
  save({"--ranks", "1"});
  fs::rename(file_, one);
  save({"--ranks", "3"});
  expectSameParticles(one, file_);
}

TEST_F(CheckpointByRanks, GoesOnOnAnyNumberOfRanksAsIfItHadNotEnded) {
  expectSameEndOnAnyNumber();
}

class GpuCheckpointByRanks : public CheckpointByRanks {
 protected:
  void SetUp() override {
    const std::vector<std::string>& devices = availableDevices();
    if (std::find(devices.begin(), devices.end(), "cuda") == devices.end()) GTEST_SKIP() << "there is no GPU";
    where_ = "cuda";
  }
};

TEST_F(GpuCheckpointByRanks, GoesOnOnAnyNumberOfRanksAsIfItHadNotEnded) {
  expectSameEndOnAnyNumber();
}

TEST_F(CheckpointByRanks, OfProcessesOfMpiIsThatOfThreads) {
  if (!hasMpi()) GTEST_SKIP() << "there is no MPI, or it was not there when this was built";
  const std::string whole = endOf({"--ranks", "2"});
  save({"--ranks", "3"});
  EXPECT_EQ(endOf({"--resume", file_}, 2), whole);
  const std::string threads = folder_ / "threads.h5";
  fs::rename(file_, threads);
  fs::copy(folder_ / "run.parts", folder_ / "kept", fs::copy_options::recursive);
  const ChildResult result = runByMpi(2, arguments({"--frames", "9"}));
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(endOf({"--ranks", "3", "--resume", file_}), whole);
  for (const auto& entry : fs::directory_iterator(folder_ / "kept"))
    fs::copy(entry.path(), folder_ / "run.parts", fs::copy_options::overwrite_existing);
  expectSameParticles(threads, file_);
}

TEST_F(CheckpointByRanks, ARunWithoutRanksGoesOnFromItAndTakesItsPlace) {
  save({"--ranks", "2"});
  const auto more = [&](const std::string& frames) {
    const ChildResult result = runWeir(arguments({"--frames", frames, "--resume", file_}));
    EXPECT_EQ(result.code, 0) << result.err;
  };
  more("13");
  EXPECT_EQ(runWeir({"info", file_, folder_ / "run.previous.h5"}).code, 0);
  EXPECT_EQ(parts(), (std::set<std::string>{"2.rank_0.h5", "2.rank_1.h5"}));
  more("17");
  EXPECT_EQ(runWeir({"info", file_, folder_ / "run.previous.h5"}).code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "run.parts"));
}

TEST_F(CheckpointByRanks, InfoTellsOfAllParts) {
  save({"--ranks", "2"});
  const ChildResult all = runWeir({"info", file_}), one = runWeir({"info", part("2.rank_1.h5")});
  EXPECT_EQ(all.code, 0) << all.err;
  const std::string particles = groupedText(stateOf(file_).at("nodes/water/particles/id").rows);
  for (const std::string& text : std::vector<std::string>{
           "a checkpoint, whole", "frame: 8", "particles of water: " + particles,
           "other files: 2: run.parts/2.rank_0.h5, run.parts/2.rank_1.h5", "all digests are right"})
    EXPECT_CONTAINS(all.out, text);
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_CONTAINS(one.out, "a part of a checkpoint, whole");
  EXPECT_CONTAINS(one.out, "of rank: 1");
}

TEST_F(CheckpointByRanks, APartThatIsMissingDamagedOrOfAnotherCheckpointIsNamed) {
  save({"--ranks", "2"});
  const std::string name = "the part run.parts/2.rank_1.h5 of the checkpoint ", path = part("2.rank_1.h5");
  const std::string bytes = readFile(path);
  fs::resize_file(path, bytes.size() / 2);
  expectBroken(name + "cannot be read: ");
  const StateArrays own = [&] {
    std::ofstream(path) << bytes;
    return Hdf5CheckpointStore().read(path).state;
  }();
  // A bit of its positions, as they stand in the file.
  const auto& positions = own.at("nodes/water/particles/position").data;
  std::string flipped = bytes;
  const std::string some(reinterpret_cast<const char*>(positions.data()), 24);
  const std::size_t at = flipped.find(some);
  ASSERT_NE(at, std::string::npos);
  flipped[at] = static_cast<char>(flipped[at] ^ 1);
  std::ofstream(path) << flipped;
  expectBroken(name +
               "cannot be read: the checkpoint is damaged: its array 'nodes/water/particles/position'");
  // Of the other rank, of the checkpoint before, and of another run at the same frame.
  for (const char* other : {"2.rank_0.h5", "1.rank_1.h5"}) {
    fs::copy(part(other), path, fs::copy_options::overwrite_existing);
    expectBroken(name + "is of another checkpoint");
  }
  std::ofstream(path) << bytes;
  EXPECT_EQ(runWeir({"info", file_}).code, 0);
  fs::remove(path);
  expectBroken(name + "is missing");
}

TEST_F(CheckpointByRanks, APartOfAnotherRunIsRefused) {
  save({"--ranks", "2"});
  const std::string mine = file_;
  fs::create_directory(folder_ / "other");
  file_ = folder_ / "other/run.h5";
  save({"--ranks", "2", "--set", "nozzle.seed=77"});
  fs::copy(folder_ / "other/run.parts/2.rank_0.h5", part("2.rank_0.h5"),
           fs::copy_options::overwrite_existing);
  file_ = mine;
  expectBroken("the part run.parts/2.rank_0.h5 of the checkpoint is of another checkpoint");
}

TEST_F(CheckpointByRanks, APartIsNoCheckpoint) {
  save({"--ranks", "2"});
  const ChildResult result = runWeir({"run", scene_, "--quiet", "--resume", part("2.rank_1.h5")});
  EXPECT_EQ(result.code, 5);
  EXPECT_CONTAINS(result.err, "this is the part of a checkpoint that rank 1 has written");
}

TEST_F(CheckpointByRanks, AllRanksTakeTheOneBeforeWhereOneFindsAPartDamaged) {
  const std::string whole = endOf({"--ranks", "3"});
  save({"--ranks", "3"});
  fs::resize_file(part("2.rank_2.h5"), 1000);
  std::vector<std::string> all =
      arguments({"--ranks", "3", "--frames", kEnd, "--resume", "auto", "--stats", folder_ / "auto.json"});
  std::erase(all, "--quiet");
  const ChildResult result = runWeir(all);
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_CONTAINS(result.err, "going on without a checkpoint: ");
  EXPECT_CONTAINS(result.err, "the part run.parts/2.rank_2.h5 of the checkpoint cannot be read");
  EXPECT_CONTAINS(result.err, "going on from " + (folder_ / "run.previous.h5"));
  EXPECT_EQ(writeJson(*parseJson(readFile(folder_ / "auto.json"), "auto.json").find("nodes")), whole);
}

TEST_F(CheckpointByRanks, IsReadWhereItIsMovedToAndThroughALink) {
  const std::string whole = endOf({"--ranks", "2"});
  save({"--ranks", "2"});
  fs::create_directory(folder_ / "moved");
  for (const std::string name : {"run.h5", "run.parts"})
    fs::rename(folder_ / name, folder_ / ("moved/" + name));
  EXPECT_EQ(endOf({"--ranks", "2", "--resume", folder_ / "moved/run.h5"}), whole);
  fs::create_symlink(folder_ / "moved/run.h5", folder_ / "link.h5");
  EXPECT_EQ(endOf({"--ranks", "1", "--resume", folder_ / "link.h5"}), whole);
}

TEST_F(CheckpointByRanks, AFullDiskLeavesTheLastOneAndNoParts) {
  const SmallDisk disk("2m");
  if (!disk.isThere()) GTEST_SKIP() << "this user may not mount a file system";
  const std::string whole = endOf({"--ranks", "2"});
  fs::create_directory_symlink(disk.path(), folder_ / "run.parts");
  save({"--ranks", "2"});
  const std::set<std::string> before = parts();
  EXPECT_EQ(before.size(), 4u);
  std::ofstream(disk / "filling") << std::string(std::size_t{1} << 22, 'x');
  const ChildResult result = runWeir(arguments({"--ranks", "2", "--resume", file_}));
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_CONTAINS(result.err, "No space left on device");
  EXPECT_CONTAINS(result.err, "run.parts/3.rank_");
  EXPECT_EQ(result.err.find("error: "), result.err.rfind("error: ")) << result.err;
  fs::remove(disk / "filling");
  EXPECT_EQ(parts(), before);
  EXPECT_EQ(runWeir({"info", file_, folder_ / "run.previous.h5"}).code, 0);
  EXPECT_EQ(endOf({"--ranks", "3", "--resume", file_}), whole);
}

TEST_F(CheckpointByRanks, KilledProcessesLeaveAWholeOneAtEveryMoment) {
  if (!hasMpi()) GTEST_SKIP() << "there is no MPI, or it was not there when this was built";
  const std::vector<std::string> longer{"--duration", "20"};
  const char* const last = "40";
  const std::string whole = endOf(with({"--ranks", "3"}, longer), 1, last);
  std::vector<std::string> all = arguments(with(longer, {"--frames", last, "--resume", "auto"}));
  *std::find(all.begin(), all.end(), "4") = "1";
  std::mt19937 random(5);
  for (int kills = 0; kills < 4; ++kills) {
    const auto before = fs::exists(file_) ? fs::last_write_time(file_) : fs::file_time_type();
    const std::chrono::microseconds more(random() % 20000);
    Meanwhile killer([&](int launcher) {
      const std::vector<int> ranks = childrenOf(launcher);
      if (!fs::exists(file_) || fs::last_write_time(file_) == before || ranks.size() != 2) return false;
      std::this_thread::sleep_for(more);
      return ::kill(ranks[static_cast<std::size_t>(kills % 2)], SIGKILL) == 0;
    });
    EXPECT_NE(runByMpi(2, all, killer.options()).code, 0);
    const ChildResult info = runWeir({"info", file_});
    ASSERT_EQ(info.code, 0) << info.err;
  }
  EXPECT_EQ(endOf(with({"--resume", file_}, longer), 2, last), whole);
  // Parts of checkpoints that were not made go with the next one.
  ASSERT_EQ(runByMpi(2, all).code, 0);
  EXPECT_EQ(parts().size(), 4u);
}

}  // namespace
}  // namespace weir::test
