// The group "video" of the section "render", through the program.
#include <gtest/gtest.h>

#include "tests/plugins/video/video_tools.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

class VideoSettingsOfRuns : public testing::Test {
 protected:
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", R"({
    "weir": 1,
    "world": { "dt": 0.005, "duration": 0.1, "frame_rate": 50, "gravity": [0, 0, 0] },
    "nodes": {
      "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.2, 0.2, 0.2] } },
      "water": { "type": "ParticleFluid", "params": { "spacing": 0.05 } }
    },
    "links": [ "block.particles -> water.initial" ],
    "render": { "width": 128, "height": 72 }
  })");

  ChildResult run(const std::string& video, const std::vector<std::string>& settings) {
    std::vector<std::string> arguments{"run", scene, "--quiet", "--video", folder / video};
    for (const std::string& setting : settings)
      arguments.insert(arguments.end(), {"--set", "render.video." + setting});
    return runWeir(arguments);
  }
};

TEST_F(VideoSettingsOfRuns, ChooseTheCodec) {
  const ChildResult result = run("run.mkv", {"codec=ffv1"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(probeVideo(folder / "run.mkv").codec, "ffv1");
  EXPECT_EQ(probeVideo(folder / "run.mkv").frames, 6);
}

TEST_F(VideoSettingsOfRuns, ChooseTheQuality) {
  ASSERT_EQ(run("fine.mp4", {"quality=95"}).code, 0);
  ASSERT_EQ(run("coarse.mp4", {"quality=5"}).code, 0);
  EXPECT_GT(readFile(folder / "fine.mp4").size(), 2 * readFile(folder / "coarse.mp4").size());
}

TEST_F(VideoSettingsOfRuns, ChooseRateAndSpeed) {
  // 6 frames, which are 0.02 s apart.
  struct Case {
    std::vector<std::string> settings;
    std::string rate;
    int frames;
  };
  const std::vector<Case> cases{{{"speed=0.5"}, "25/1", 6},
                                {{"rate=100", "speed=0.5"}, "100/1", 24},
                                {{"rate=25"}, "25/1", 3},
                                {{"rate=30"}, "30/1", 4},  // at 0, 1/30, 2/30 and 3/30 s
                                {{"rate=25", "speed=2"}, "25/1", 2}};
  for (const Case& tested : cases) {
    const ChildResult result = run("run.mp4", tested.settings);
    ASSERT_EQ(result.code, 0) << result.err;
    const VideoInfo info = probeVideo(folder / "run.mp4");
    EXPECT_EQ(info.frameRate, tested.rate) << tested.settings.front();
    EXPECT_EQ(info.frames, tested.frames) << tested.settings.front();
  }
}

TEST_F(VideoSettingsOfRuns, SayWhatCannotBe) {
  const ChildResult wrongFile = run("run.gif", {"codec=av1"});
  EXPECT_EQ(wrongFile.code, 3);
  EXPECT_CONTAINS(wrongFile.err, "/render/video/codec");
  EXPECT_CONTAINS(wrongFile.err, "a .gif file cannot hold AV1");
  const ChildResult unknown = run("run.mp4", {"codec=h265"});
  EXPECT_EQ(unknown.code, 3);
  EXPECT_CONTAINS(unknown.err, "h264");
  EXPECT_EQ(run("run.mp4", {"quality=101"}).code, 3);
}

}  // namespace
}  // namespace weir::test
