// Checkpoints: a run that was killed and resumed ends, bit by bit, as one that was not.
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>
#include <utility>

#include "framework/scene/scene_file.h"
#include "plugins/vtkhdf/checkpoint_file.h"
#include "plugins/vtkhdf/hdf5.h"
#include "plugins/vtkhdf/vtkhdf_reader.h"
#include "tests/plugins/vtkhdf/sample_run.h"
#include "tests/support/child_process.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

/// All that has a state of its own: an emitter, a sink, a moving solid, and a solver that iterates as needed,
/// in steps that follow the motion.
const char* const kScene = R"({"weir": 1,
  "world": {"dt": 0.01, "cfl": 0.4, "frame_rate": 50, "duration": 0.4, "seed": 3},
  "nodes": {
    "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.3, 0.1, 0.3], "jitter": 0.1}},
    "nozzle": {"type": "CircleEmitter",
               "params": {"position": [0.1, 0.3, 0.1], "radius": 0.05, "jitter": 0.2,
                          "speed": {"keyframes": [[0, 0.5], [0.4, 1.5]]}}},
    "drain": {"type": "Sink", "params": {"min": [0.25, -1, 0.25], "max": [0.4, 0.02, 0.4]}},
    "room": {"type": "BoxMesh", "params": {"min": [0, 0, 0], "max": [0.3, 0.5, 0.3]}},
    "walls": {"type": "SemiAnalyticalSFI", "params": {"fill": "container"}},
    "blade": {"type": "BoxMesh", "params": {"min": [0.1, 0.02, 0.14], "max": [0.2, 0.12, 0.16]}},
    "stirrer": {"type": "SemiAnalyticalSFI",
                "params": {"angular_velocity": [0, 6, 0], "pivot": [0.15, 0, 0.15]}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "rest_steps": 5},
              "modules": {"solver": {"type": "AcceleratedSolver",
                                     "params": {"tolerance": 0.02, "max_iterations": 3, "acceleration": "nesterov"}}}}},
  "links": ["block.particles -> water.initial", "nozzle.particles -> water.emitters", "drain.sink -> water.sinks",
            "room.surface -> walls.solids", "water.fluid -> walls.fluid",
            "blade.surface -> stirrer.solids", "water.fluid -> stirrer.fluid"]})";

class CheckpointOfRun : public testing::Test {
 protected:
  CheckpointOfRun() { folder_.write("scene.json", kScene); }

  ChildResult run(const std::string& name, std::vector<std::string> more, const ChildOptions& options = {}) {
    std::vector<std::string> arguments{
        "run",      folder_ / "scene.json",       "--device", device_,
        "--export", folder_ / (name + ".vtkhdf"), "--series", folder_ / (name + ".jsonl")};
    if (device_ == "cpu") arguments.insert(arguments.end(), {"--threads", "2"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runWeir(arguments, options);
  }

  std::string checkpoint() const { return folder_ / "state.h5"; }

  /// Of every frame, without the times that it took.
  std::vector<Value> seriesOf(const std::string& name) const {
    std::vector<Value> frames;
    std::istringstream lines(readFile(folder_ / (name + ".jsonl")));
    for (std::string line; std::getline(lines, line);) {
      Value frame = parseJson(line, name);
      frame["stepping_seconds"] = 0;
      frames.push_back(std::move(frame));
    }
    return frames;
  }

  void expectSame(const std::string& one, const std::string& other) const {
    EXPECT_EQ(seriesOf(one), seriesOf(other));
    const VtkHdfReader a(folder_ / (one + ".vtkhdf")), b(folder_ / (other + ".vtkhdf"));
    ASSERT_EQ(a.times(), b.times());
    for (std::size_t k = 0; k < a.times().size(); ++k) {
      const VtkHdfStep left = a.read(k), right = b.read(k);
      EXPECT_EQ(left.positions, right.positions) << "frame " << k;
      ASSERT_EQ(left.arrays.size(), right.arrays.size());
      for (std::size_t i = 0; i < left.arrays.size(); ++i) {
        EXPECT_EQ(left.arrays[i].name, right.arrays[i].name);
        EXPECT_EQ(left.arrays[i].values, right.arrays[i].values) << left.arrays[i].name << " at frame " << k;
      }
    }
  }

  TemporaryFolder folder_;
  std::string device_ = "cpu";
};

TEST_F(CheckpointOfRun, GoesOnBitByBitWhereItWas) {
  const ChildResult whole = run("whole", {});
  ASSERT_EQ(whole.code, 0) << whole.err;
  ASSERT_EQ(run("parts", {"--checkpoint", checkpoint(), "--checkpoint-every", "8", "--frames", "11"}).code,
            0);
  // The export holds frames behind the checkpoint, which come again.
  const ChildResult resumed = run("parts", {"--resume", checkpoint()});
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  expectSame("whole", "parts");
}

TEST_F(CheckpointOfRun, HoldsTheStatesOfAPluginsNode) {
  const std::string file =
      folder_.write("waves.json", R"({"weir": 1, "world": {"dt": 0.01, "frame_rate": 50, "duration": 0.16},
        "nodes": {
          "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.3, 0.1, 0.2]}},
          "room": {"type": "BoxMesh", "params": {"min": [-0.2, 0, 0], "max": [0.3, 0.5, 0.2]}},
          "walls": {"type": "SemiAnalyticalSFI", "params": {"fill": "container"}},
          "board": {"type": "BoxMesh", "params": {"min": [-0.06, 0, 0], "max": [0, 0.3, 0.2]}},
          "paddle": {"type": "WavePaddle", "params": {"stroke": 0.2, "period": 0.5, "ramp": 0}},
          "water": {"type": "ParticleFluid", "params": {"spacing": 0.03}}},
        "links": ["block.particles -> water.initial", "room.surface -> walls.solids", "water.fluid -> walls.fluid",
                  "board.surface -> paddle.solids", "water.fluid -> paddle.fluid"]})");
  folder_.write("scene.json", readFile(file));
  const std::vector<std::string> plugin{"--plugin",
                                        buildFolder() + "/lib/weir/test_plugins/weir_wave_paddle.so"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), plugin.begin(), plugin.end());
    return more;
  };
  const ChildResult whole = run("whole", with({}));
  ASSERT_EQ(whole.code, 0) << whole.err;
  ASSERT_EQ(
      run("parts", with({"--checkpoint", checkpoint(), "--checkpoint-every", "3", "--frames", "4"})).code, 0);
  const ChildResult resumed = run("parts", with({"--resume", checkpoint()}));
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  expectSame("whole", "parts");
  const std::vector<Value> frames = seriesOf("parts");
  const Value* paddle = frames.back().find("nodes")->find("paddle");
  EXPECT_GT(std::abs(paddle->find("position")->asDouble()), 0.05) << "it moves";
}

TEST_F(CheckpointOfRun, OfAnOlderFormatIsRefusedWithAWayToGoOn) {
  ASSERT_EQ(run("a", {"--checkpoint", checkpoint(), "--checkpoint-every", "1", "--frames", "1"}).code, 0);
  {
    const hdf5::Session session;
    hdf5::File file = hdf5::File::reopen(checkpoint());
    {
      hdf5::Group root = file.root().group("checkpoint");
      root.setAttribute("format", std::int64_t{1});
    }
    file.close();
  }
  const ChildResult result = run("a", {"--resume", checkpoint()});
  EXPECT_EQ(result.code, 5);
  EXPECT_CONTAINS(result.err, checkpoint());
  EXPECT_CONTAINS(result.err, "format 1");
  EXPECT_CONTAINS(result.err, "run the scene from the start");
}

TEST_F(CheckpointOfRun, ModulesAreTimedOverTheStepsOfTheProcess) {
  ASSERT_EQ(run("run", {"--checkpoint", checkpoint(), "--checkpoint-every", "8", "--frames", "8"}).code, 0);
  const std::int64_t before = seriesOf("run").back().find("steps")->asInt();
  ASSERT_GT(before, 0);
  const std::string file = folder_ / "stats.json";
  ASSERT_EQ(run("run", {"--resume", checkpoint(), "--frames", "11", "--stats", file}).code, 0);
  const Value stats = parseJson(readFile(file), file);
  const Value& solver = *stats.find("modules_ms")->find("water/solver");
  const double steps = solver.find("total")->asDouble() / solver.find("per_step")->asDouble();
  EXPECT_NEAR(steps, static_cast<double>(stats.find("steps")->asInt() - before), 1e-6);
}

TEST_F(CheckpointOfRun, SurvivesAKill) {
  const std::vector<std::string> endless{"--duration", "1000", "--checkpoint", checkpoint()};
  const auto more = [](std::vector<std::string> all, const std::vector<std::string>& options) {
    all.insert(all.end(), options.begin(), options.end());
    return all;
  };
  ChildOptions killed;
  killed.onStderr = [&](int pid, const std::string&) {
    constexpr int kMost = 20'000;  // ms
    for (int i = 0; i < kMost && !fs::exists(checkpoint()); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(pid, SIGKILL);
  };
  EXPECT_EQ(run("killed", more(endless, {"--checkpoint-every", "1"}), killed).signal, SIGKILL);
  ASSERT_TRUE(fs::exists(checkpoint()));
  const std::string last = std::to_string(VtkHdfReader(folder_ / "killed.vtkhdf").times().size() + 4);
  const ChildResult resumed = run("killed", more(endless, {"--resume", checkpoint(), "--frames", last}));
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  ASSERT_EQ(run("whole", {"--duration", "1000", "--frames", last}).code, 0);
  expectSame("whole", "killed");
}

TEST_F(CheckpointOfRun, KeepsTheLastTwo) {
  ASSERT_EQ(run("a", {"--checkpoint", checkpoint(), "--checkpoint-every", "3", "--frames", "7"}).code, 0);
  const Hdf5CheckpointStore store;
  const auto frameOf = [&](const std::string& file) {
    std::int64_t frame = 0;
    const Checkpoint read = store.read(file);
    StateReader(read.state).in("clock").get("frame", frame);
    return frame;
  };
  EXPECT_EQ(frameOf(checkpoint()), 6);
  EXPECT_EQ(frameOf(folder_ / "state.previous.h5"), 3);
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder_.path())) ++files;
  EXPECT_EQ(files, 5u) << "the scene, two outputs, two checkpoints";
}

TEST_F(CheckpointOfRun, IsRefusedByAnotherScene) {
  ASSERT_EQ(run("a", {"--checkpoint", checkpoint(), "--checkpoint-every", "1", "--frames", "1"}).code, 0);
  const ChildResult other =
      run("b", {"--resume", checkpoint(), "--set", "water.spacing=0.03", "--set", "world.seed=4"});
  EXPECT_EQ(other.code, 5);
  EXPECT_CONTAINS(other.err, "nodes.water.params.spacing: 0.02 then, 0.03 now");
  EXPECT_CONTAINS(other.err, "world.seed: 3 then, 4 now");
  EXPECT_FALSE(fs::exists(folder_ / "b.vtkhdf"));
  // More time is not another scene.
  EXPECT_EQ(run("a", {"--resume", checkpoint(), "--duration", "0.5", "--frames", "2"}).code, 0);
}

// Without a GPU, a checkpoint of the CPU says that it is of CUDA, where states are the same.
TEST_F(CheckpointOfRun, OfAnotherBackEndGoesOnWithAWarning) {
  ASSERT_EQ(run("whole", {}).code, 0);
  ASSERT_EQ(run("parts", {"--checkpoint", checkpoint(), "--checkpoint-every", "8", "--frames", "11"}).code,
            0);
  const Hdf5CheckpointStore store;
  Checkpoint changed = store.read(checkpoint());
  EXPECT_EQ(changed.device, "cpu");
  changed.device = "cuda";
  fs::remove(checkpoint());
  store.write(checkpoint(), changed);
  const ChildResult resumed = run("parts", {"--resume", checkpoint()});
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_CONTAINS(resumed.err, "the checkpoint was made on cuda and goes on on cpu");
  expectSame("whole", "parts");
}

class CheckpointOfCuda : public CheckpointOfRun {
 protected:
  /// The number of the water's particles in the last line, and its kinetic energy.
  std::pair<double, double> endOf(const std::string& name) const {
    const std::vector<Value> frames = seriesOf(name);
    const Value* const water = frames.back().find("nodes")->find("water");
    return {water->find("particles")->asDouble(), water->find("kinetic_energy")->asDouble()};
  }
};

TEST_F(CheckpointOfCuda, GoesOnOnTheCpuAndTheOtherWayRound) {
  const std::vector<std::string>& devices = availableDevices();
  if (std::find(devices.begin(), devices.end(), "cuda") == devices.end()) GTEST_SKIP() << "there is no GPU";
  for (const auto& [from, to] : {std::pair("cpu", "cuda"), std::pair("cuda", "cpu")}) {
    device_ = from;
    ASSERT_EQ(run("whole", {}).code, 0);
    ASSERT_EQ(run("parts", {"--checkpoint", checkpoint(), "--checkpoint-every", "8", "--frames", "11"}).code,
              0);
    device_ = to;
    const ChildResult resumed = run("parts", {"--resume", checkpoint()});
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_CONTAINS(resumed.err, "the checkpoint was made on " + std::string(from));
    // Twelve frames on, bits have parted, and the water has not.
    const auto [particles, energy] = endOf("parts");
    const auto [ofWhole, energyOfWhole] = endOf("whole");
    EXPECT_NEAR(particles / ofWhole, 1, 0.02);
    EXPECT_NEAR(energy / energyOfWhole, 1, 0.1);
  }
}

// Of the same size and at the same path, so that nothing but the content tells.
TEST_F(CheckpointOfRun, IsRefusedWhereAFileThatTheSceneReadsHasChanged) {
  const std::string mesh =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
      "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  const std::string particles = "x,y,z\n0.1,0.1,0.1\n0.15,0.1,0.1\n";
  folder_.write("mesh.ply", mesh);
  folder_.write("drops.csv", particles);
  folder_.write("scene.json", R"({"weir": 1, "world": {"dt": 0.01, "frame_rate": 50, "duration": 0.1},
    "nodes": {"drops": {"type": "ParticleFile", "params": {"file": "drops.csv"}},
              "solid": {"type": "MeshFile", "params": {"file": "mesh.ply"}},
              "wall": {"type": "StaticBoundary", "params": {"inverted": true}},
              "water": {"type": "ParticleFluid", "params": {"spacing": 0.05}}},
    "links": ["drops.particles -> water.initial", "solid.surface -> wall.meshes",
              "wall.boundary -> water.boundaries"]})");
  const ChildResult first =
      run("a", {"--checkpoint", checkpoint(), "--checkpoint-every", "1", "--frames", "2"});
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(run("a", {"--resume", checkpoint(), "--frames", "3"}).code, 0);
  folder_.write("mesh.ply", std::string(mesh).replace(mesh.find("1 0 0"), 5, "2 0 0"));
  const ChildResult otherMesh = run("a", {"--resume", checkpoint()});
  EXPECT_EQ(otherMesh.code, 5);
  EXPECT_CONTAINS(otherMesh.err, "solid.file: the file \"mesh.ply\" is another now");
  folder_.write("mesh.ply", mesh);
  folder_.write("drops.csv", std::string(particles).replace(particles.find("0.15"), 4, "0.16"));
  const ChildResult otherDrops = run("a", {"--resume", checkpoint()});
  EXPECT_EQ(otherDrops.code, 5);
  EXPECT_CONTAINS(otherDrops.err, "drops.file: the file \"drops.csv\" is another now");
}

TEST_F(CheckpointOfRun, ThatIsNoneIsAnError) {
  const std::string junk = folder_.write("junk.h5", "no HDF5");
  for (const std::string& file : {junk, folder_ / "missing.h5"}) {
    const ChildResult result = run("a", {"--resume", file});
    EXPECT_EQ(result.code, 5);
    EXPECT_CONTAINS(result.err, file);
  }
  EXPECT_EQ(run("a", {"--resume", folder_ / "scene.json"}).code, 2);
  EXPECT_EQ(run("a", {"--checkpoint", checkpoint(), "--checkpoint-every", "often"}).code, 2);
}

TEST(CheckpointFile, KeepsEveryKindOfArray) {
  const TemporaryFolder folder;
  Checkpoint checkpoint{
      .version = "1.2", .scene = "{\"a\": \"ü\"}", .device = "cpu", .inputs = "{}", .state = {}};
  struct Odd {
    char c;
    double d;
  };
  const std::vector<Vec3f> vectors{{1, 2, 3}, {-0.0f, 1e-40f, 1e38f}};
  const std::vector<Odd> odd{{'x', 0.1}, {'y', -1e300}};
  const StateWriter to = StateWriter(checkpoint.state).in("a").in("b");
  to.put("vectors", std::span<const Vec3f>(vectors));
  to.put("odd", std::span<const Odd>(odd));
  to.put("none", std::span<const int>());
  to.put("long", std::int64_t{1} << 60);
  StateWriter(checkpoint.state).put("top", 0.1);

  const Hdf5CheckpointStore store;
  store.write(folder / "c.h5", checkpoint);
  const Checkpoint read = store.read(folder / "c.h5");
  EXPECT_EQ(read.version, checkpoint.version);
  EXPECT_EQ(read.scene, checkpoint.scene);
  EXPECT_EQ(read.device, checkpoint.device);
  EXPECT_EQ(read.inputs, checkpoint.inputs);
  ASSERT_EQ(read.state.size(), checkpoint.state.size());
  for (const auto& [path, array] : checkpoint.state) {
    const auto found = read.state.find(path);
    ASSERT_NE(found, read.state.end()) << path;
    EXPECT_EQ(found->second.kind, array.kind) << path;
    EXPECT_EQ(found->second.rows, array.rows) << path;
    EXPECT_EQ(found->second.columns, array.columns) << path;
    EXPECT_EQ(found->second.data, array.data) << path;
  }
  // What is there is not touched.
  EXPECT_THROW(store.write(folder / "c.h5", checkpoint), Error);
}

TEST(StateReader, NamesWhatIsMissingOrOfAnotherKind) {
  StateArrays arrays;
  StateWriter(arrays).in("water").put("count", 3);
  const StateReader from = StateReader(arrays).in("water");
  double number = 0;
  EXPECT_CONTAINS(errorOf([&] { from.get("count", number); }).what(), "water/count");
  int count = 0;
  from.get("count", count);
  EXPECT_EQ(count, 3);
  EXPECT_CONTAINS(errorOf([&] { from.get("speed", number); }).what(), "water/speed");
}

TEST(CheckpointInterval, IsOfFramesOrSeconds) {
  EXPECT_EQ(CheckpointInterval::parse("20").frames, 20);
  EXPECT_EQ(CheckpointInterval::parse("1.5s").seconds, 1.5);
  for (const char* bad : {"", "s", "0", "-3", "1.5", "2m", "1e99", "nan", "infs"})
    EXPECT_EQ(errorOf([&] { CheckpointInterval::parse(bad); }).kind(), ErrorKind::kUsage) << bad;
}

}  // namespace
}  // namespace weir::test
