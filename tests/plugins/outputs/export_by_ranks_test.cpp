// --export with export.by_rank=true on several ranks: a file of each rank, and one that stands for all.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>

#include "plugins/vtkhdf/vtkhdf_reader.h"
#include "tests/plugins/outputs/meanwhile.h"
#include "tests/plugins/outputs/ranks_run.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/small_disk.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEndless = "1000";  // s, of a run that is ended before, however slow this process is

class ExportByRanks : public RanksTest {
 protected:
  ExportByRanks() { scene_ = folder_.write("scene.json", kStateful); }

  std::vector<std::string> arguments(const std::string& file, const std::vector<std::string>& more) const {
    std::vector<std::string> all{"run",      scene_, "--quiet",  "--set", "export.by_rank=true",
                                 "--export", file,   "--device", where_};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  ChildResult writeAt(const std::string& file, const std::vector<std::string>& more) const {
    return runWeir(arguments(file, more));
  }
  /// "/…/NAME/run.vtkhdf", of a run with these options, which must succeed.
  std::string written(const std::string& name, const std::vector<std::string>& more) const {
    fs::create_directory(folder_ / name);
    const std::string file = folder_ / (name + "/run.vtkhdf");
    const ChildResult result = writeAt(file, more);
    EXPECT_EQ(result.code, 0) << result.err;
    return file;
  }
  std::string where_ = "cpu";

  std::string ofTwo() const { return written("two", {"--ranks", "2", "--frames", "4"}); }

  static std::string part(const std::string& file, const std::string& name) {
    return fs::path(file).parent_path() / "run_ranks" / name;
  }
  static bool areParts(const std::string& file) {
    return fs::exists(fs::path(file).parent_path() / "run_ranks");
  }

  /// By our reader and by each VTK that the build knows.
  void expectSame(const std::string& one, const std::string& other) const {
    expectSameExports(one, other);
    const std::string program = fs::path(WEIR_READ_STEPS).parent_path() / "same_exports.py";
    std::istringstream pythons(WEIR_TEST_PYTHONS);
    for (std::string python; std::getline(pythons, python, ':');) {
      const ChildResult result = runChild(python, {"-B", program, one, other});
      EXPECT_EQ(result.code, 0) << result.out << result.err;
      EXPECT_EQ(result.out, std::to_string(VtkHdfReader(one).times().size()) + "\n");
    }
  }
  void expectSameForTwoToFourRanks() const {
    const std::string one = written("1", {"--ranks", "1"});
    EXPECT_FALSE(areParts(one));
    for (const std::string ranks : {"2", "3", "4"}) {
      const std::string file = written(
          ranks, {"--ranks", ranks, "--stats", folder_ / (ranks + ".json"), "--series", folder_ / "s.csv"});
      expectSame(one, file);
      for (int rank = 0; rank < std::stoi(ranks); ++rank)
        EXPECT_TRUE(fs::exists(part(file, "rank_" + std::to_string(rank) + ".vtkhdf")));
      EXPECT_EQ(gatheredBy(folder_ / (ranks + ".json")), 0);
    }
  }
  static std::int64_t gatheredBy(const std::string& statistics, const char* node = "water") {
    const Value all = parseJson(readFile(statistics), statistics);
    return all.find("ranks")->find(node)->find("gathered")->asInt();
  }
  /// A frame behind those of an export.
  static std::string someMoreThan(const std::string& file) {
    return std::to_string(VtkHdfReader(file).times().size() + 4);
  }
  void expectBroken(const std::string& file, const std::string& problem) const {
    const std::vector<std::vector<std::string>> commands{
        {"info", file}, {"render", file, "--scene", scene_, "--images", folder_ / "images"}};
    for (const std::vector<std::string>& command : commands) {
      const ChildResult result = runWeir(command);
      EXPECT_EQ(result.code, 5) << command.front();
      EXPECT_CONTAINS(result.err, file);
      EXPECT_CONTAINS(result.err, problem);
    }
  }
};

TEST_F(ExportByRanks, IsThatOfOneRankForVtkAndForOurReader) {
  expectSameForTwoToFourRanks();
  EXPECT_FALSE(areParts(written("none", {})));
}

class GpuExportByRanks : public ExportByRanks {
 protected:
  void SetUp() override {
    const std::vector<std::string>& devices = availableDevices();
    if (std::find(devices.begin(), devices.end(), "cuda") == devices.end()) GTEST_SKIP() << "there is no GPU";
    where_ = "cuda";
  }
};

TEST_F(GpuExportByRanks, IsThatOfOneRankForVtkAndForOurReader) {
  expectSameForTwoToFourRanks();
}

TEST_F(ExportByRanks, IsTheSameFromProcessesOfMpi) {
  if (!hasMpi()) GTEST_SKIP() << "there is no MPI, or it was not there when this was built";
  const std::string one = written("1", {"--ranks", "1"}), file = folder_ / "run.vtkhdf";
  const ChildResult result =
      runByMpi(2, arguments(file, {"--threads", "1", "--stats", folder_ / "mpi.json"}));
  ASSERT_EQ(result.code, 0) << result.err;
  expectSame(one, file);
  EXPECT_EQ(gatheredBy(folder_ / "mpi.json"), 0);
}

TEST_F(ExportByRanks, HasRoundedPositionsAndChosenAttributesAndFrames) {
  const std::vector<std::string> changes{"--set", "export.position_error=1e-4",
                                         "--set", "export.every=3",
                                         "--set", R"(export.attributes=["velocity"])"};
  auto with = [&](const std::string& ranks) {
    std::vector<std::string> all{"--ranks", ranks};
    all.insert(all.end(), changes.begin(), changes.end());
    return all;
  };
  expectSame(written("1", with("1")), written("3", with("3")));
}

TEST_F(ExportByRanks, WhatElseIsWrittenIsGatheredAsEver) {
  const std::string file = written("2", {"--ranks", "2", "--frames", "3", "--stats", folder_ / "s.json",
                                         "--ply-particles", folder_ / "ply"});
  EXPECT_TRUE(areParts(file));
  EXPECT_GT(gatheredBy(folder_ / "s.json"), 0);
  expectSame(written("1", {"--ranks", "1", "--frames", "3"}), file);
}

TEST_F(ExportByRanks, StandsAsOneWhereverItIsMoved) {
  const std::string one = written("1", {"--ranks", "1", "--frames", "4"}), file = ofTwo();
  fs::rename(fs::path(file).parent_path(), folder_ / "moved 100%");
  expectSame(one, folder_ / "moved 100%/run.vtkhdf");
  fs::create_symlink(folder_ / "moved 100%/run.vtkhdf", folder_ / "link.vtkhdf");
  expectSame(one, folder_ / "link.vtkhdf");
}

TEST_F(ExportByRanks, ANameMayHaveAnySigns) {
  const std::string one = written("1", {"--ranks", "1", "--frames", "2"}), file = folder_ / "a %b%%.vtkhdf";
  const ChildResult result = writeAt(file, {"--ranks", "2", "--frames", "2"});
  ASSERT_EQ(result.code, 0) << result.err;
  expectSame(one, file);
}

TEST_F(ExportByRanks, InfoSaysOfWhichFilesItConsists) {
  const std::string file = ofTwo();
  const ChildResult all = runWeir({"info", file}), alone = runWeir({"info", part(file, "rank_1.vtkhdf")});
  EXPECT_EQ(all.code, 0) << all.err;
  for (const char* text :
       {"an export of particles, whole", "frames: 5", "run: has ended",
        "other files: 3: run_ranks/cells.hdf5, run_ranks/rank_0.vtkhdf, run_ranks/rank_1.vtkhdf"})
    EXPECT_CONTAINS(all.out, text);
  EXPECT_EQ(alone.code, 0) << alone.err;
  EXPECT_CONTAINS(alone.out, "of rank: 1");
}

TEST_F(ExportByRanks, AMissingFileIsNamed) {
  const std::string file = ofTwo();
  fs::remove(part(file, "rank_1.vtkhdf"));
  expectBroken(file, "of the 3 other files that this one consists of, run_ranks/rank_1.vtkhdf is missing");
  fs::remove_all(fs::path(file).parent_path() / "run_ranks");
  expectBroken(file, "run_ranks/cells.hdf5 is missing, run_ranks/rank_0.vtkhdf is missing");
}

TEST_F(ExportByRanks, ADamagedFileIsNamed) {
  const std::string file = ofTwo(), damaged = part(file, "rank_0.vtkhdf"), whole = readFile(damaged);
  fs::resize_file(damaged, whole.size() / 2);
  expectBroken(file, "run_ranks/rank_0.vtkhdf is damaged: ");
  std::ofstream(damaged) << "something else";
  expectBroken(file, "run_ranks/rank_0.vtkhdf is damaged: this is not an HDF5 file");
}

TEST_F(ExportByRanks, AFileOfAnotherRunOrOneThatIsTooShortIsNamed) {
  const std::string file = ofTwo();
  const std::string other =
      written("other", {"--ranks", "2", "--frames", "4", "--set", "water.rest_density=900"});
  const std::string shorter = written("shorter", {"--ranks", "2", "--frames", "2"});
  const auto replace = [&](const std::string& by, const std::string& problem) {
    fs::copy_file(part(by, "rank_1.vtkhdf"), part(file, "rank_1.vtkhdf"),
                  fs::copy_options::overwrite_existing);
    expectBroken(file, "run_ranks/rank_1.vtkhdf " + problem);
  };
  replace(other, "is of another run");
  replace(shorter, "ends before its last frame");
}

TEST_F(ExportByRanks, AnEarlierOneIsReplacedWithItsFiles) {
  const std::string file = written("2", {"--ranks", "4", "--frames", "4"});
  EXPECT_TRUE(fs::exists(part(file, "rank_3.vtkhdf")));
  ASSERT_EQ(writeAt(file, {"--ranks", "2", "--frames", "2"}).code, 0);
  EXPECT_FALSE(fs::exists(part(file, "rank_2.vtkhdf")));
  expectSame(written("1", {"--ranks", "1", "--frames", "2"}), file);
}

TEST_F(ExportByRanks, ARunStartsFromItsParticles) {
  const std::string file = ofTwo();
  scene_ = folder_.write("again.json", R"({"weir": 1, "world": {"frame_rate": 100, "duration": 0.01},
    "nodes": {"file": {"type": "ParticleFile", "params": {"file": "two/run.vtkhdf"}},
              "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "rest_steps": 0}}},
    "links": ["file.particles -> water.initial"]})");
  const VtkHdfReader from(file), to(written("again", {"--frames", "0"}));
  EXPECT_EQ(to.read(0).positions.size(), from.readLast().positions.size());
}

TEST_F(ExportByRanks, WhatIsSharedByTwoFluidsStandsFluidByFluid) {
  scene_ = folder_.write("fluids.json", R"({"weir": 1,
    "world": {"dt": 0.004, "frame_rate": 50, "duration": 0.1},
    "nodes": {
      "left": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.2, 0.2, 0.1]}},
      "right": {"type": "BoxSampler", "params": {"min": [0.3, 0.1, 0], "max": [0.5, 0.2, 0.1]}},
      "floor": {"type": "StaticBoundary", "params": {"shape": "plane"}},
      "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "rest_steps": 3, "pressure": true}},
      "oil": {"type": "ParticleFluid", "params": {"spacing": 0.025, "rest_density": 900, "rest_steps": 3}}},
    "links": ["left.particles -> water.initial", "right.particles -> oil.initial",
              "floor.boundary -> water.boundaries", "floor.boundary -> oil.boundaries"]})");
  expectSame(written("1", {"--ranks", "1"}), written("3", {"--ranks", "3"}));
}

/// Ranks have no order of white water that one rank has.
TEST_F(ExportByRanks, HasTheSameWhiteWaterInAnOrderOfItsOwn) {
  scene_ = resourcesFolder() + "/scenes/white_water.json";
  const std::vector<std::string> coarse{
      "--set", "water.spacing=0.05", "--set", "water.rest_steps=0", "--duration", "0.3"};
  const auto valuesOf = [&](const std::string& ranks) {
    std::vector<std::string> more{"--ranks", ranks};
    more.insert(more.end(), coarse.begin(), coarse.end());
    const VtkHdfStep step = VtkHdfReader(written(ranks, more)).readLast();
    const auto& ids = std::get<std::vector<std::int64_t>>(step.find("id")->values);
    const auto& fluids = std::get<std::vector<std::int64_t>>(step.find("fluid_index")->values);
    std::set<std::tuple<std::int64_t, std::int64_t, float, float, float>> values;
    for (std::size_t i = 0; i < ids.size(); ++i)
      values.emplace(fluids[i], ids[i], step.positions[i].x, step.positions[i].y, step.positions[i].z);
    EXPECT_EQ(values.size(), ids.size());
    return values;
  };
  const auto one = valuesOf("1");
  EXPECT_EQ(std::get<0>(*one.rbegin()), 1);
  EXPECT_TRUE(valuesOf("3") == one);
}

TEST_F(ExportByRanks, GoesOnFromACheckpointOfAsManyRanks) {
  const std::vector<std::string> save{"--ranks", "3", "--checkpoint", folder_ / "c.h5", "--checkpoint-every",
                                      "4"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), save.begin(), save.end());
    return more;
  };
  const std::string one = written("1", {"--ranks", "1"});
  // Two frames more than the checkpoint has, which go.
  const std::string file = written("3", with({"--frames", "6"}));
  EXPECT_EQ(VtkHdfReader(file).times().size(), 7u);
  EXPECT_EQ(runWeir({"info", folder_ / "c.h5"}).code, 0);
  ASSERT_EQ(writeAt(file, with({"--resume", folder_ / "c.h5"})).code, 0);
  expectSame(one, file);
}

TEST_F(ExportByRanks, IsRefusedByOtherRanksThatWouldGoOnWithIt) {
  const std::string file = written(
      "2", {"--ranks", "2", "--frames", "4", "--checkpoint", folder_ / "c.h5", "--checkpoint-every", "4"});
  const std::vector<std::string> resume{"--resume", folder_ / "c.h5"};
  const auto refused = [&](std::vector<std::string> more, const std::string& now) {
    more.insert(more.end(), resume.begin(), resume.end());
    const ChildResult result = writeAt(file, more);
    EXPECT_EQ(result.code, 5) << result.err;
    EXPECT_CONTAINS(result.err,
                    "the export was written as a file of each of 2 ranks, and would go on as " + now);
  };
  refused({"--ranks", "3"}, "a file of each of 3 ranks");
  refused({"--ranks", "1"}, "one file");
  refused({"--ranks", "2", "--set", "export.by_rank=false"}, "one file");
  EXPECT_EQ(VtkHdfReader(file).times().size(), 5u);
  const ChildResult without =
      runWeir({"run", scene_, "--quiet", "--frames", "5", "--ranks", "3", "--resume", folder_ / "c.h5"});
  EXPECT_EQ(without.code, 0) << without.err;
}

TEST_F(ExportByRanks, AFullDiskEndsAllRanksWithOneSentence) {
  const SmallDisk disk("2m");
  if (!disk.isThere()) GTEST_SKIP() << "this user may not mount a file system";
  const std::string file = folder_ / "run.vtkhdf";
  fs::create_directory(folder_ / "run_ranks");
  // Only rank 1 writes to the small disk.
  std::ofstream(disk / "rank_1.vtkhdf") << "\n";
  fs::create_symlink(disk / "rank_1.vtkhdf", folder_ / "run_ranks/rank_1.vtkhdf");
  const ChildResult result = writeAt(file, {"--ranks", "3", "--duration", "20"});
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_CONTAINS(result.err, "rank 1: ");
  EXPECT_CONTAINS(result.err, "No space left on device");
  EXPECT_CONTAINS(result.err, "rank_1.vtkhdf");
  EXPECT_EQ(result.err.find("error: "), result.err.rfind("error: ")) << result.err;
  EXPECT_GT(expectReadable(file), 3u);
  EXPECT_EQ(runWeir({"info", file}).code, 0);
}

TEST_F(ExportByRanks, AKilledRunHasWholeFramesAndGoesOn) {
  if (!hasMpi()) GTEST_SKIP() << "there is no MPI, or it was not there when this was built";
  const std::string file = folder_ / "run.vtkhdf", checkpoint = folder_ / "run.h5";
  std::vector<std::string> all = arguments(file, {"--threads", "1", "--duration", kEndless, "--checkpoint",
                                                  checkpoint, "--checkpoint-every", "2", "--resume", "auto"});
  for (int kills = 0; kills < 3; ++kills) {
    const auto before = fs::exists(checkpoint) ? fs::last_write_time(checkpoint) : fs::file_time_type();
    Meanwhile killer([&](int launcher) {
      const std::vector<int> ranks = childrenOf(launcher);
      return fs::exists(checkpoint) && fs::last_write_time(checkpoint) != before && ranks.size() == 2 &&
             ::kill(ranks[static_cast<std::size_t>(kills % 2)], SIGKILL) == 0;
    });
    EXPECT_NE(runByMpi(2, all, killer.options()).code, 0);
    EXPECT_GE(expectReadable(file), 3u);
    for (const auto& entry : fs::directory_iterator(folder_ / "run_ranks"))
      if (entry.path().extension() == ".vtkhdf") expectReadable(entry.path());
  }
  const std::string last = someMoreThan(file);
  all.insert(all.end(), {"--frames", last});
  const ChildResult whole = runByMpi(2, all);
  ASSERT_EQ(whole.code, 0) << whole.err;
  expectSame(written("1", {"--ranks", "1", "--duration", kEndless, "--frames", last}), file);
}

TEST_F(ExportByRanks, AWarnedRunSavesOnAllRanksAndGoesOn) {
  const std::string file = folder_ / "run.vtkhdf";
  std::vector<std::string> all = arguments(
      file, {"--ranks", "2", "--duration", kEndless, "--checkpoint", folder_ / "c.h5", "--resume", "auto"});
  std::erase(all, "--quiet");
  ChildOptions options;
  options.onStderr = [sent = false](int pid, const std::string& err) mutable {
    if (!sent && contains(err, "frame ")) sent = ::kill(pid, SIGUSR1) == 0;
  };
  const ChildResult warned = runWeir(all, options);
  EXPECT_EQ(warned.code, 75) << warned.err;
  const std::string last = someMoreThan(file);
  all.insert(all.end(), {"--frames", last});
  const ChildResult whole = runWeir(all);
  EXPECT_EQ(whole.code, 0) << whole.err;
  expectSame(written("1", {"--ranks", "1", "--duration", kEndless, "--frames", last}), file);
}

}  // namespace
}  // namespace weir::test
