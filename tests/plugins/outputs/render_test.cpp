// weir render: an export looks as its run did, without being simulated again.
#include <filesystem>

#include "tests/plugins/outputs/written_run.h"
#include "tests/plugins/video/video_tools.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

/// Two fluids, a moving solid, and a boundary; colours by an attribute.
constexpr const char* kScene = R"({"weir": 1,
  "world": {"dt": 0.005, "frame_rate": 50, "duration": 0.12},
  "nodes": {
    "left": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.1, 0.1, 0.1]}},
    "right": {"type": "BoxSampler", "params": {"min": [0.2, 0.1, 0], "max": [0.3, 0.2, 0.1]}},
    "tank": {"type": "StaticBoundary",
             "params": {"shape": "box", "min": [0, 0, 0], "max": [0.3, 0.3, 0.1], "inverted": true}},
    "blade": {"type": "BoxMesh", "params": {"min": [0.14, 0.02, 0.02], "max": [0.16, 0.2, 0.08]}},
    "stirrer": {"type": "SemiAnalyticalSFI",
                "params": {"angular_velocity": [0, 0, 6], "pivot": [0.15, 0.1, 0.05]}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "rest_steps": 3}},
    "oil": {"type": "ParticleFluid", "params": {"spacing": 0.025, "rest_density": 900, "rest_steps": 3}}},
  "links": ["left.particles -> water.initial", "right.particles -> oil.initial",
            "tank.boundary -> water.boundaries", "tank.boundary -> oil.boundaries",
            "blade.surface -> stirrer.solids", "water.fluid -> stirrer.fluid"],
  "render": {"width": 96, "height": 64, "color": {"by": "density"}}})";
constexpr int kFrames = 7;

class RenderCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    files_ = std::make_unique<TemporaryFolder>();
    files_->write("scene.json", kScene);
    const ChildResult result = runWeir({"run", *files_ / "scene.json", "--device", "cpu", "--threads", "2",
                                        "--export", *files_ / "run.vtkhdf", "--images", *files_ / "run"});
    ASSERT_EQ(result.code, 0) << result.err;
  }
  static void TearDownTestSuite() { files_.reset(); }

  ChildResult render(std::vector<std::string> more) const {
    std::vector<std::string> all{"render", *files_ / "run.vtkhdf", "--scene", *files_ / "scene.json"};
    all.insert(all.end(), more.begin(), more.end());
    return runWeir(all);
  }

  static std::string nameOf(int frame) { return "/frame_0000" + std::to_string(frame) + ".png"; }

  /// Of the folder of images of this test.
  void expectImagesOfTheRun() const {
    for (int frame = 0; frame < kFrames; ++frame)
      EXPECT_TRUE(readFile(images + nameOf(frame)) == readFile(*files_ / "run" + nameOf(frame))) << frame;
  }

  static std::unique_ptr<TemporaryFolder> files_;
  TemporaryFolder folder;
  std::string images = folder / "images";
};

std::unique_ptr<TemporaryFolder> RenderCommand::files_;

TEST_F(RenderCommand, ImagesThatBeginWithAResumedRunHaveTheNumbersOfItsFrames) {
  const std::string scene = *files_ / "scene.json", checkpoint = folder / "run.h5";
  const ChildResult first = runWeir({"run", scene, "--quiet", "--device", "cpu", "--threads", "2", "--frames",
                                     "3", "--checkpoint", checkpoint, "--checkpoint-every", "3"});
  ASSERT_EQ(first.code, 0) << first.err;
  const ChildResult second = runWeir({"run", scene, "--quiet", "--device", "cpu", "--threads", "2",
                                      "--frames", "5", "--resume", checkpoint, "--images", images});
  ASSERT_EQ(second.code, 0) << second.err;
  for (int frame = 0; frame < kFrames; ++frame)
    EXPECT_EQ(fs::exists(images + nameOf(frame)), frame == 4 || frame == 5) << frame;
}

TEST_F(RenderCommand, ShowsWhatTheRunShowed) {
  std::vector<std::string> more{"--images", images};
  if (canMakeVideos()) more.insert(more.end(), {"--video", folder / "run.mp4"});
  const ChildResult result = render(more);
  ASSERT_EQ(result.code, 0) << result.err;
  expectImagesOfTheRun();
  if (!canMakeVideos()) return;
  const VideoInfo video = probeVideo(folder / "run.mp4");
  EXPECT_EQ(video.frames, kFrames);
  EXPECT_EQ(video.frameRate, "50/1");
}

TEST_F(RenderCommand, ShowsOneFrameAlone) {
  const std::vector<std::string> colors{"--set", "render.color.range=[900, 1100]", "--set",
                                        "render.color.bar=false"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), colors.begin(), colors.end());
    return render(more);
  };
  ASSERT_EQ(with({"--images", folder / "all"}).code, 0);
  const ChildResult result = with({"--images", images, "--frame", "3"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_TRUE(readFile(images + nameOf(3)) == readFile(folder / "all" + nameOf(3)));
  for (const int other : {0, 2, 4}) EXPECT_FALSE(fs::exists(images + nameOf(other))) << other;
  const ChildResult none = with({"--images", images, "--frame", "7"});
  EXPECT_EQ(none.code, 2);
  EXPECT_CONTAINS(none.err, "the file has no frame 7");
  EXPECT_CONTAINS(none.err, "0 to 6");
}

TEST_F(RenderCommand, DrawsNoPictureTwice) {
  ASSERT_EQ(render({"--images", images}).code, 0);
  fs::remove(images + nameOf(3));
  fs::remove(images + nameOf(6));
  // A sign by which a picture that is left alone is known.
  fs::copy_file(images + nameOf(0), images + nameOf(1), fs::copy_options::overwrite_existing);
  const ChildResult again = render({"--images", images});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_CONTAINS(again.err, "5 pictures were there and have not been drawn again");
  EXPECT_TRUE(readFile(images + nameOf(1)) == readFile(images + nameOf(0)));
  EXPECT_TRUE(readFile(images + nameOf(3)) == readFile(*files_ / "run" + nameOf(3)));
  EXPECT_TRUE(readFile(images + nameOf(6)) == readFile(*files_ / "run" + nameOf(6)));
}

TEST_F(RenderCommand, ShowsTheSurfaceThatTheRunShowed) {
  // A surface is made by a node at each frame; a replay has the particles alone.
  std::string text = kScene;
  const std::string before = R"("water": {"type": "ParticleFluid")",
                    links = R"("water.fluid -> stirrer.fluid")";
  text.replace(text.find(before), before.size(), R"("skin": {"type": "FluidSurface"}, )" + before);
  text.replace(text.find(links), links.size(), links + R"(, "water.fluid -> skin.fluid")");
  const std::string scene = folder.write("scene.json", text), file = folder / "run.vtkhdf";
  ASSERT_EQ(runWeir({"run", scene, "--device", "cpu", "--export", file, "--images", folder / "run"}).code, 0);
  ASSERT_EQ(runWeir({"render", file, "--scene", scene, "--images", images}).code, 0);
  for (int frame = 0; frame < kFrames; ++frame)
    EXPECT_TRUE(readFile(images + nameOf(frame)) == readFile(folder / "run" + nameOf(frame))) << frame;
}

TEST_F(RenderCommand, DrawsPicturesOfOtherSettingsAgain) {
  ASSERT_EQ(render({"--images", images, "--set", "render.color.by=none"}).code, 0);
  EXPECT_FALSE(readFile(images + nameOf(2)) == readFile(*files_ / "run" + nameOf(2)));
  const ChildResult again = render({"--images", images});
  EXPECT_FALSE(contains(again.err, "have not been drawn again")) << again.err;
  expectImagesOfTheRun();
  // The same settings, but another map in the file.
  const std::string map = folder.write("map.csv", "1,0,0\n0,0,1\n"), colored = folder / "colored";
  const std::vector<std::string> mapped{"--images", colored, "--set", "render.color.file=" + map};
  ASSERT_EQ(render(mapped).code, 0);
  const std::string before = readFile(colored + nameOf(2));
  folder.write("map.csv", "0,1,0\n0,0,1\n");
  EXPECT_FALSE(contains(render(mapped).err, "have not been drawn again"));
  EXPECT_FALSE(readFile(colored + nameOf(2)) == before);
  // What a run writes is not noted.
  fs::copy(images, folder / "run");
  ASSERT_EQ(runWeir({"run", *files_ / "scene.json", "--device", "cpu", "--images", folder / "run", "--frames",
                     "0", "--set", "render.color.by=none"})
                .code,
            0);
  EXPECT_FALSE(fs::exists(folder / "run/frames.txt"));
}

TEST_F(RenderCommand, UsesPicturesThatAreThereForTheVideo) {
  if (!canMakeVideos()) GTEST_SKIP() << "ffmpeg or ffprobe is not on the PATH";
  ASSERT_EQ(render({"--images", images}).code, 0);
  const ChildResult result = render({"--images", images, "--video", folder / "run.mp4"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_CONTAINS(result.err, "7 pictures were there");
  EXPECT_EQ(probeVideo(folder / "run.mp4").frames, kFrames);
}

TEST_F(RenderCommand, SaysWhatTheFileDoesNotHave) {
  const auto expectFailure = [&](const ChildResult& result, int code, const std::vector<std::string>& parts) {
    EXPECT_EQ(result.code, code) << result.err;
    for (const std::string& part : parts) EXPECT_CONTAINS(result.err, part);
  };
  expectFailure(render({"--images", images, "--set", "render.color.by=vorticity"}), 3,
                {"no attribute 'vorticity'", "density"});
  expectFailure(render({}), 2, {"nothing is to be made", "--video"});
  expectFailure(render({"--images", *files_ / "run.vtkhdf"}), 2, {"would overwrite the export"});
  std::string text = kScene;
  text.replace(text.find("\"oil\""), 5, "\"tar\"");
  text.replace(text.find("oil.initial"), 11, "tar.initial");
  text.replace(text.find("oil.boundaries"), 14, "tar.boundaries");
  const std::string other = folder.write("other.json", text);
  expectFailure(runWeir({"render", *files_ / "run.vtkhdf", "--scene", other, "--images", images}), 5,
                {"particles of the fluid 'oil', which the scene does not have", "tar"});
  expectFailure(runWeir({"render", other, "--scene", other, "--images", images}), 2, {".vtkhdf"});
  const std::string junk = folder.write("junk.vtkhdf", "no HDF5");
  expectFailure(runWeir({"render", junk, "--scene", other, "--images", images}), 5, {junk});
}

/// The looks of the two fluids, and more settings of the section "render"; colours are by speed without any.
std::string sceneWithLooks(const std::string& water, const std::string& oil, const std::string& more = "") {
  std::string text = kScene;
  const std::string section = R"("color": {"by": "density"})";
  const std::string looks =
      R"("fluids": [{"node": "water", )" + water + R"(}, {"node": "oil", )" + oil + "}]";
  text.replace(text.find(section), section.size(), looks + more);
  return text;
}

TEST_F(RenderCommand, NeedsVelocitiesOnlyWhereTheyAreShown) {
  const std::string exported = folder / "still.vtkhdf";
  const ChildResult run =
      runWeir({"run", *files_ / "scene.json", "--device", "cpu", "--threads", "2", "--frames", "1",
               "--export", exported, "--set", R"(export.attributes=["density"])"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto show = [&](const std::string& scene) {
    fs::remove_all(images);
    return runWeir({"render", exported, "--scene", folder.write("looks.json", scene), "--images", images,
                    "--threads", "2"});
  };
  const std::string clear = R"("look": "water")", balls = R"("look": "spheres")";
  const auto foam = [&](const std::string& by) { return clear + R"(, "foam": {"by": ")" + by + R"("})"; };
  for (const std::string& scene :
       {std::string(kScene), sceneWithLooks(clear, clear), sceneWithLooks(foam("density"), clear),
        sceneWithLooks(balls, clear, R"(, "color": {"by": "none"})"),
        sceneWithLooks(balls, balls, R"(, "particles": "none")")}) {
    const ChildResult result = show(scene);
    EXPECT_EQ(result.code, 0) << scene << result.err;
    EXPECT_TRUE(fs::exists(images + nameOf(1))) << scene;
  }
  const auto expectRefused = [&](const std::string& scene, const std::vector<std::string>& parts) {
    const ChildResult result = show(scene);
    EXPECT_EQ(result.code, 5) << scene << result.err;
    EXPECT_CONTAINS(result.err, "no attribute 'velocity'");
    for (const std::string& part : parts) EXPECT_CONTAINS(result.err, part);
    EXPECT_FALSE(fs::exists(images + nameOf(0))) << scene;
  };
  expectRefused(sceneWithLooks(clear, balls), {exported, "'oil'", "render.color.by", "'speed'", "density"});
  expectRefused(sceneWithLooks(clear, balls, R"(, "color": {"by": "velocity"})"), {"'oil'", "'velocity'"});
  expectRefused(sceneWithLooks(clear, foam("speed")), {"'oil'", "render.fluids[1].foam.by", "'speed'"});
  expectRefused(sceneWithLooks(clear, clear, R"(, "arrows": {"spacing": 0.05})"), {"render.arrows.spacing"});
}

}  // namespace
}  // namespace weir::test
