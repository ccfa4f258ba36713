// `weir run --ranks N --images`: the pictures of one rank, for which nothing is gathered if they show spheres
// alone.
#include <algorithm>
#include <filesystem>
#include <functional>

#include "tests/plugins/outputs/ranks_run.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDam = R"({
  "weir": 1,
  "world": { "dt": 0.004, "frame_rate": 25, "duration": 0.2 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.3, 0.6, 0.3] } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [1, 1, 0.3], "inverted": true } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.04 } }
  },
  "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries"],
  "render": { "width": 320, "height": 180 }
})";

/// Two fluids, of which one comes from an emitter, so that no rank has any at first, and one is white; cut
/// open, and seen by cameras of which one fits what all ranks have.
constexpr const char* kTwoFluids = R"({
  "weir": 1,
  "world": { "dt": 0.004, "frame_rate": 25, "duration": 0.2 },
  "nodes": {
    "jet": { "type": "CircleEmitter",
             "params": { "position": [0.5, 0.5, 0.2], "rotation": [0, 0, 20], "radius": 0.08, "speed": 2 } },
    "block": { "type": "BoxSampler", "params": { "min": [-0.4, 0.1, 0], "max": [0.1, 0.3, 0.3] } },
    "floor": { "type": "StaticBoundary", "params": { "shape": "plane" } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.04 } },
    "milk": { "type": "ParticleFluid", "params": { "spacing": 0.04 } }
  },
  "links": ["jet.particles -> water.emitters", "floor.boundary -> water.boundaries",
            "block.particles -> milk.initial", "floor.boundary -> milk.boundaries"],
  "render": { "width": 320, "height": 180, "fluids": [ { "node": "milk", "look": "white" } ],
              "clips": [ { "point": [0, 0, 0.2], "normal": [0, 0, 1] } ],
              "color": { "by": "density" },
              "cameras": [ { "name": "side", "eye": [0.3, 0.3, 3], "target": [0.3, 0.3, 0] } ],
              "plots": [ { "of": "water.particles" } ] }
})";

class PicturesOnRanks : public RanksTest {
 protected:
  std::string where_ = "cpu";

  std::vector<std::string> arguments(const std::string& name, const std::vector<std::string>& more) const {
    fs::create_directory(folder_ / name);
    std::vector<std::string> all{"run",
                                 scene_,
                                 "--quiet",
                                 "--device",
                                 where_,
                                 "--threads",
                                 "1",
                                 "--images",
                                 folder_ / (name + "/images"),
                                 "--stats",
                                 folder_ / (name + "/stats.json")};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Outcome outcomeOf(const std::string& name, ChildResult result) const {
    EXPECT_EQ(result.code, 0) << result.err;
    Outcome run{.result = std::move(result), .files = {}, .statistics = {}};
    if (run.result.code != 0) return run;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / (name + "/images")))
      if (entry.is_regular_file())
        run.files[entry.path().lexically_relative(folder_ / name).string()] = readFile(entry.path().string());
    run.statistics = parseJson(readFile(folder_ / (name + "/stats.json")), "stats.json");
    return run;
  }
  Outcome drawn(const std::string& name, const std::vector<std::string>& more) const {
    return outcomeOf(name, runWeir(arguments(name, more)));
  }
  static std::int64_t gathered(const Outcome& run, const char* node = "water") {
    return run.statistics.find("ranks")->find(node)->find("gathered")->asInt();
  }
  static void expectSamePictures(const Outcome& one, const Outcome& other) {
    ASSERT_GE(one.files.size(), 4u);
    ASSERT_EQ(other.files.size(), one.files.size());
    for (const auto& [file, bytes] : one.files) EXPECT_TRUE(other.files.at(file) == bytes) << file;
  }
  void expectSamePicturesGathered(const std::string& change) const {
    SCOPED_TRACE(change);
    const std::string name = std::to_string(std::hash<std::string>{}(change));
    const Outcome one = drawn(name + "_1", {"--ranks", "1", "--set", change});
    const Outcome two = drawn(name + "_2", {"--ranks", "2", "--set", change});
    expectSamePictures(one, two);
    EXPECT_GT(gathered(two), 0);
  }
  void expectSamePicturesUngathered() const {
    const Outcome one = drawn("1", {"--ranks", "1"});
    for (const std::string ranks : {"2", "3", "5"}) {
      SCOPED_TRACE(ranks);
      const Outcome several = drawn(ranks, {"--ranks", ranks});
      expectSamePictures(one, several);
      EXPECT_EQ(gathered(several), 0);
    }
  }
};

TEST_F(PicturesOnRanks, AreThoseOfOneRankOfADamBreakInATank) {
  scene_ = folder_.write("scene.json", kDam);
  expectSamePicturesUngathered();
}

class GpuPicturesOnRanks : public PicturesOnRanks {
 protected:
  void SetUp() override {
    const std::vector<std::string>& devices = availableDevices();
    if (std::find(devices.begin(), devices.end(), "cuda") == devices.end()) GTEST_SKIP() << "there is no GPU";
    where_ = "cuda";
  }
};

TEST_F(GpuPicturesOnRanks, AreThoseOfOneRankOfADamBreakInATank) {
  scene_ = folder_.write("scene.json", kDam);
  expectSamePicturesUngathered();
}

TEST_F(PicturesOnRanks, SoAreThoseOfTwoFluidsByTwoCameras) {
  scene_ = folder_.write("scene.json", kTwoFluids);
  expectSamePicturesUngathered();
  EXPECT_EQ(gathered(drawn("again", {"--ranks", "2"}), "milk"), 0);
}

TEST_F(PicturesOnRanks, AreTheSameBesideAnOutputThatGathers) {
  scene_ = folder_.write("scene.json", kDam);
  const Outcome one = drawn("1", {"--ranks", "1"});
  const Outcome two = drawn("2", {"--ranks", "2", "--ply-particles", folder_ / "ply"});
  expectSamePictures(one, two);
  EXPECT_GT(gathered(two), 0);
}

TEST_F(PicturesOnRanks, GoOnFromACheckpointOfAnotherNumberOfRanks) {
  scene_ = folder_.write("scene.json", kDam);
  const std::vector<std::string> range{"--set", "render.color.range=[0,3]"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), range.begin(), range.end());
    return more;
  };
  const Outcome one = drawn("1", with({"--ranks", "1"}));
  const std::string checkpoint = folder_ / "run.h5";
  drawn("2", with({"--ranks", "2", "--frames", "3", "--checkpoint", checkpoint, "--checkpoint-every", "2"}));
  expectSamePictures(one, drawn("2", with({"--ranks", "3", "--resume", checkpoint})));
}

TEST_F(PicturesOnRanks, OfMoreThanSpheresAreDrawnOfWhatIsGathered) {
  scene_ = folder_.write("scene.json", kDam);
  expectSamePicturesGathered(R"(render.fluids=[{"node":"water","look":"water"}])");
  expectSamePicturesGathered("render.environment.exposure=1.2");
  expectSamePicturesGathered("render.arrows.spacing=0.1");
  expectSamePicturesGathered("render.camera.follow=water");
  std::string withSolid = kDam;
  withSolid.replace(
      withSolid.find("\"block\""), 0,
      R"("ball": { "type": "StaticBoundary", "params": { "shape": "sphere", "radius": 0.1 } }, )");
  scene_ = folder_.write("solid.json", withSolid);
  expectSamePicturesGathered("ball.radius=0.2");
}

TEST_F(PicturesOnRanks, AreTheSameFromProcessesOfMpi) {
  if (!hasMpi()) GTEST_SKIP() << "there is no MPI, or it was not there when this was built";
  scene_ = folder_.write("scene.json", kDam);
  const Outcome one = drawn("1", {"--ranks", "1"});
  const Outcome two = outcomeOf("mpi", runByMpi(2, arguments("mpi", {})));
  expectSamePictures(one, two);
  EXPECT_EQ(gathered(two), 0);
}

}  // namespace
}  // namespace weir::test
