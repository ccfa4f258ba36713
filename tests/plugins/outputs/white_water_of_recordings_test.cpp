// White water that is made afterwards, of an export, is that of the run.
#include <gtest/gtest.h>

#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

/// Water that is thrown at a wall. White water goes from frame to frame, and shows where it is alone.
constexpr const char* kScene = R"({"weir": 1,
  "world": {"dt": 0.005, "frame_rate": 20, "duration": 0.3},
  "nodes": {
    "block": {"type": "BoxSampler", "params": {"min": [-0.4, 0, -0.1], "max": [0, 0.2, 0.1], "velocity": [4, 1, 0]}},
    "tank": {"type": "StaticBoundary",
             "params": {"shape": "box", "min": [-0.5, 0, -0.15], "max": [0.3, 0.5, 0.15], "inverted": true}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.04, "rest_steps": 0}}FOAM},
  "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries"LINK],
  "render": {"width": 96, "height": 64, "camera": {"eye": [-0.1, 0.4, 1.2], "target": [-0.1, 0.2, 0]},
             "overlay": false, "color": {"by": "none"}}})";
constexpr const char* kFoam = R"(,
    "foam": {"type": "WhiteWater", "params": {"trapped_air": 2e6, "air_limits": [0.02, 0.3], "max_dt": 1}})";
constexpr int kFrames = 6;

std::string sceneWith(const std::string& foam, const std::string& link) {
  std::string scene = kScene;
  scene.replace(scene.find("FOAM"), 4, foam);
  return scene.replace(scene.find("LINK"), 4, link);
}

class WhiteWaterOfRecordings : public testing::Test {
 protected:
  WhiteWaterOfRecordings()
      : plain(folder.write("plain.json", sceneWith("", ""))),
        foamy(folder.write("foamy.json", sceneWith(kFoam, ", \"water.fluid -> foam.fluid\""))) {}

  ChildResult run(const std::string& scene, const std::vector<std::string>& more) const {
    std::vector<std::string> all{"run", scene, "--device", "cpu", "--threads", "2", "--quiet"};
    all.insert(all.end(), more.begin(), more.end());
    return runWeir(all);
  }
  ChildResult render(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"render", recording, "--scene", foamy, "--device", "cpu", "--quiet"};
    all.insert(all.end(), more.begin(), more.end());
    return runWeir(all);
  }
  std::string picture(const std::string& images, int frame) const {
    return readFile(folder / images + "/frame_0000" + std::to_string(frame) + ".png");
  }

  TemporaryFolder folder;
  std::string plain, foamy, recording = folder / "run.vtkhdf";
};

TEST_F(WhiteWaterOfRecordings, IsThatOfTheRun) {
  ASSERT_EQ(run(plain, {"--export", recording, "--images", folder / "plain"}).code, 0);
  const ChildResult whole = run(foamy, {"--images", folder / "whole"});
  ASSERT_EQ(whole.code, 0) << whole.err;
  const ChildResult after = render({"--images", folder / "after"});
  ASSERT_EQ(after.code, 0) << after.err;
  for (int frame = 0; frame <= kFrames; ++frame)
    EXPECT_EQ(picture("after", frame), picture("whole", frame)) << frame;
  EXPECT_NE(picture("plain", kFrames), picture("whole", kFrames)) << "there is none to be seen";
}

TEST_F(WhiteWaterOfRecordings, OfOneFrameHasTheFramesBeforeInIt) {
  ASSERT_EQ(run(plain, {"--export", recording}).code, 0);
  ASSERT_EQ(render({"--images", folder / "all"}).code, 0);
  ASSERT_EQ(render({"--images", folder / "one", "--frame", "5"}).code, 0);
  EXPECT_EQ(picture("one", 5), picture("all", 5));
}

TEST_F(WhiteWaterOfRecordings, IsRefusedWhereTheRecordingLacksWhatItNeeds) {
  const ChildResult made = run(plain, {"--export", recording, "--set", "export.attributes=[\"velocity\"]"});
  ASSERT_EQ(made.code, 0) << made.err;
  const ChildResult result = render({"--images", folder / "none"});
  EXPECT_EQ(result.code, 5);
  EXPECT_CONTAINS(result.err, "no attribute 'id' of the fluid 'water', which 'foam' needs");
}

}  // namespace
}  // namespace weir::test
