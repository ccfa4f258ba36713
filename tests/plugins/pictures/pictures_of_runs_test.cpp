// Videos and pictures through the program, and what it says where they cannot be made.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <map>

#include "framework/scene/scene_file.h"
#include "tests/plugins/video/read_png.h"
#include "tests/plugins/video/video_tools.h"
#include "tests/support/expect_error.h"
#include "tests/support/small_disk.h"

namespace weir::test {
namespace {

constexpr const char* kFallingCube = R"({
  "weir": 1,
  "world": { "dt": 0.002, "duration": 0.1, "frame_rate": 50 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0.3, 0], "max": [0.2, 0.5, 0.2] } },
    "floor": { "type": "StaticBoundary", "params": { "shape": "plane" } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.02 } }
  },
  "links": [ "block.particles -> water.initial", "floor.boundary -> water.boundaries" ],
  "render": { "width": 320, "height": 180 }
})";

class PicturesOfRuns : public testing::Test {
 protected:
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", kFallingCube);
};

TEST_F(PicturesOfRuns, VideoAndImagesShowEveryFrame) {
  const std::string video = folder / "run.mp4", images = folder / "images", stats = folder / "stats.json";
  const ChildResult result = runWeir({"run", scene, "--video", video, "--images", images, "--stats", stats});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_CONTAINS(result.out, video + "\n");
  const VideoInfo info = probeVideo(video);
  EXPECT_EQ(info.width, 320);
  EXPECT_EQ(info.height, 180);
  EXPECT_EQ(info.frames, 6);  // that of time 0, and 5 in 0.1 s
  EXPECT_EQ(info.frameRate, "50/1");
  for (int frame = 0; frame < info.frames; ++frame)
    EXPECT_TRUE(std::filesystem::exists(images + "/frame_0000" + std::to_string(frame) + ".png")) << frame;
  const Value statistics = parseJson(readFile(stats), stats);
  const Value* cost = statistics.find("outputs")->find("pictures");
  ASSERT_NE(cost, nullptr);
  EXPECT_GT(cost->find("write_seconds")->asDouble(), 0);
  EXPECT_GT(cost->find("capture_seconds")->asDouble(), 0);
  double parts = 0;
  for (const char* part : {"view_seconds", "draw_seconds", "label_seconds", "hand_over_seconds"})
    parts += cost->find(part)->asDouble();
  EXPECT_GT(cost->find("draw_seconds")->asDouble(), 0);
  EXPECT_LE(parts, cost->find("write_seconds")->asDouble());
}

TEST_F(PicturesOfRuns, EachCameraHasPicturesOfItsOwn) {
  std::string text = kFallingCube;
  text.replace(text.find("\"width\""), 0,
               R"("cameras": [{ "name": "above", "eye": [0.1, 3, 0], "target": [0, 0, 0] },
                              { "name": "with_it", "follow": "water" }], )");
  const std::string scene2 = folder.write("cameras.json", text), images = folder / "images";
  const ChildResult result = runWeir({"run", scene2, "--video", folder / "run.mp4", "--images", images});
  ASSERT_EQ(result.code, 0) << result.err;
  std::vector<rendering::Picture> last;
  for (const std::string camera : {"", "/above", "/with_it"}) {
    for (int frame = 0; frame < 6; ++frame)
      ASSERT_TRUE(std::filesystem::exists(images + camera + "/frame_0000" + std::to_string(frame) + ".png"));
    last.push_back(readPng(images + camera + "/frame_00005.png"));
  }
  EXPECT_NE(last[0].rgb, last[1].rgb);
  EXPECT_NE(last[0].rgb, last[2].rgb);
  for (const std::string video : {"run.mp4", "run.above.mp4", "run.with_it.mp4"})
    EXPECT_EQ(probeVideo(folder / video).frames, 6) << video;

  text.replace(text.find("with_it"), 7, "above");
  const ChildResult twice = runWeir({"run", folder.write("twice.json", text), "--images", images});
  EXPECT_EQ(twice.code, 3);
  EXPECT_CONTAINS(twice.err, "two cameras are called 'above'");
}

TEST_F(PicturesOfRuns, PlotsNameWhatThereIs) {
  std::string text = kFallingCube;
  text.replace(text.find("\"width\""), 0, R"("plots": [{ "of": "water.kinetic_energie" }], )");
  const ChildResult result =
      runWeir({"run", folder.write("plots.json", text), "--images", folder / "images"});
  EXPECT_EQ(result.code, 3);
  EXPECT_CONTAINS(result.err, "/render/plots/0/of");
  EXPECT_CONTAINS(result.err, "water.kinetic_energy");
  text.replace(text.find("energie"), 7, "energy");
  const ChildResult good = runWeir({"run", folder.write("plots.json", text), "--images", folder / "images"});
  EXPECT_EQ(good.code, 0) << good.err;
}

TEST_F(PicturesOfRuns, AnAttributeOfAPluginColoursTheParticles) {
  std::string text = kFallingCube;
  text.replace(text.find("0.02 }"), 6,
               R"(0.02 }, "modules": { "tag": { "type": "Tagger", "after": "boundary" } })");
  text.replace(text.find("\"width\""), 0, R"("color": { "by": "BY", "map": "turbo" }, )");
  std::vector<rendering::Picture> pictures;
  for (const std::string by : {"tag", "speed", "no_such_thing"}) {
    std::string colored = text;
    colored.replace(colored.find("BY"), 2, by);
    const std::string images = folder / by;
    const ChildResult result = runWeir({"run", folder.write(by + ".json", colored), "--images", images,
                                        "--plugin", buildFolder() + "/lib/weir/test_plugins/tagger.so"});
    EXPECT_EQ(result.code == 0, by != "no_such_thing") << result.err;
    if (result.code == 0) {
      pictures.push_back(readPng(images + "/frame_00005.png"));
    } else {
      EXPECT_CONTAINS(result.err, "tag_vector");  // what there is
    }
  }
  ASSERT_EQ(pictures.size(), 2u);
  EXPECT_NE(pictures[0].rgb, pictures[1].rgb);
}

/// Pixels in which red is this much of the sum, or more.
int redPixels(const rendering::Picture& picture, double share) {
  int count = 0;
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3)
    count += picture.rgb[i] > share * (picture.rgb[i] + picture.rgb[i + 1] + picture.rgb[i + 2] + 1);
  return count;
}

TEST_F(PicturesOfRuns, TheSurfaceOfAFluidIsShownInPlaceOfItsParticles) {
  // Particles are green and the surface is red.
  std::string text = kFallingCube;
  text.replace(text.find("0.02 }"), 8, R"(0.02 } }, "skin": { "type": "FluidSurface" })");
  text.replace(text.find("\"links\": ["), 10, R"("links": [ "water.fluid -> skin.fluid", )");
  text.replace(
      text.find("\"width\""), 0,
      R"("color": { "by": "none", "fixed": [0, 0.8, 0], "bar": false }, "overlay": false, "ground": false,
                  "surfaces": [ { "node": "skin", "color": [1, 0, 0] OPTIONS } ], PARTICLES )");
  std::map<std::string, rendering::Picture> pictures;
  const auto draw = [&](const std::string& name, const std::string& options, const std::string& particles) {
    std::string changed = text;
    changed.replace(changed.find("OPTIONS"), 7, options);
    changed.replace(changed.find("PARTICLES"), 9, particles);
    const std::string images = folder / name;
    const ChildResult result = runWeir({"run", folder.write(name + ".json", changed), "--images", images});
    EXPECT_EQ(result.code, 0) << result.err;
    if (result.code == 0)
      for (const std::string frame : {"0", "5"})
        pictures[name + frame] = readPng(images + "/frame_0000" + frame + ".png");
  };
  draw("surface", "", "");
  draw("particles", R"(, "visible": false)", "");
  draw("neither", R"(, "visible": false)", R"("particles": "none",)");
  draw("both", "", R"("particles": "all",)");
  ASSERT_EQ(pictures.size(), 8u);
  const auto red = [&](const std::string& name) { return redPixels(pictures.at(name), 0.6); };
  EXPECT_GT(red("surface0"), 1000);
  EXPECT_GT(red("surface5"), 1000);
  // It falls with the fluid.
  EXPECT_NE(pictures.at("surface0").rgb, pictures.at("surface5").rgb);
  EXPECT_EQ(red("particles0"), 0);
  EXPECT_EQ(red("neither0"), 0);
  EXPECT_NE(pictures.at("particles0").rgb, pictures.at("neither0").rgb);
  EXPECT_GT(red("both0"), 500);
}

TEST_F(PicturesOfRuns, AFluidLooksLikeWaterIfTheSceneSaysSo) {
  const auto run = [&](const std::string& name, const std::string& render) {
    std::string text = kFallingCube;
    text.replace(text.find("\"width\""), 0, render + ", ");
    return runWeir({"run", folder.write(name + ".json", text), "--images", folder / name, "--frames", "1"});
  };
  const std::string water = R"("fluids": [{ "node": "water", "look": "water" }])";
  const std::string foam =
      R"("fluids": [{ "node": "water", "look": "water", "foam": { "by": "speed", "range": [0, 0.1] } }])";
  const std::string spheres = R"("fluids": [{ "node": "water", "look": "spheres" }])";
  std::vector<rendering::Picture> pictures;
  for (const auto& [name, render] : {std::pair{"water", water}, {"foam", foam}, {"spheres", spheres}}) {
    const ChildResult result = run(name, render);
    ASSERT_EQ(result.code, 0) << result.err;
    pictures.push_back(readPng(folder / name + "/frame_00001.png"));
  }
  EXPECT_NE(pictures[0].rgb, pictures[1].rgb);
  EXPECT_NE(pictures[0].rgb, pictures[2].rgb);
}

TEST_F(PicturesOfRuns, WrongLooksOfFluidsAreErrors) {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {R"("fluids": [{ "node": "watr", "look": "water" }])", "did you mean 'water'"},
      {R"("fluids": [{ "node": "water", "foam": { "by": "anger" } }])", "/render/fluids/0/foam/by"},
      {R"("fluids": [{ "node": "water", "foam": { "range": [2, 2] } }])", "two different values"},
      {R"("fluids": [{ "node": "water", "water": { "absorption": [1, -1, 1] } }])", "absorption"},
      {R"("environment": { "sun": [0, 0, 0] })", "a direction"}};
  for (const auto& [render, message] : wrong) {
    std::string text = kFallingCube;
    text.replace(text.find("\"width\""), 0, render + ", ");
    const ChildResult result =
        runWeir({"run", folder.write("wrong.json", text), "--images", folder / "wrong", "--frames", "0"});
    EXPECT_EQ(result.code, 3) << render;
    EXPECT_CONTAINS(result.err, message);
  }
}

TEST_F(PicturesOfRuns, AnInterruptedRunLeavesAPlayableVideo) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    ChildOptions options;
    bool sent = false;
    // To the whole group of processes, as Ctrl-C in a terminal reaches them: ffmpeg must outlive it, too.
    options.onStderr = [&](int pid, const std::string& err) {
      if (!sent && contains(err, "frame ")) sent = kill(-pid, signal) == 0;
    };
    const std::string video = folder / ("run" + std::to_string(signal) + ".mp4");
    const ChildResult result = runWeir({"run", scene, "--duration", "1000", "--video", video}, options);
    EXPECT_EQ(result.code, 130) << result.err;
    EXPECT_FALSE(result.timedOut);
    EXPECT_GE(probeVideo(video).frames, 1);
  }
}

TEST_F(PicturesOfRuns, CtrlCEndsARunThatWaitsForAnFfmpegThatHangs) {
  const std::string takes = "head -c 1000000 > /dev/null; ", all = "cat > /dev/null; ";
  for (const std::string& before : {std::string(), takes, all}) {
    SCOPED_TRACE(before);
    const FakeFfmpeg fake(before + "echo stuck >&2; sleep 1000");
    ChildOptions options;
    bool sent = false;
    options.onStderr = [&](int pid, const std::string& err) {
      if (!sent && contains(err, "frame ")) sent = kill(pid, SIGINT) == 0;
    };
    options.limit = std::chrono::seconds(50);  // less than without Ctrl-C
    const ChildResult result =
        runWeir({"run", scene, "--duration", "1000", "--video", folder / "run.mp4"}, options);
    EXPECT_FALSE(result.timedOut);
    EXPECT_EQ(result.code, 5) << result.err;
    EXPECT_CONTAINS(result.err, "for 3 s after the run was interrupted: stuck");
  }
}

TEST_F(PicturesOfRuns, AnEmptyVideoIsAnError) {
  const FakeFfmpeg fake("cat > /dev/null; exit 0");
  const ChildResult result = runWeir({"run", scene, "--frames", "2", "--video", folder / "run.mp4"});
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_CONTAINS(result.err, "the video is empty");
}

TEST_F(PicturesOfRuns, WithoutFfmpegTheRunSaysWhatToInstall) {
  const std::string video = folder / "run.mp4";
  ChildOptions options;
  options.environment["PATH"] = folder.path();
  const ChildResult result = runWeir({"run", scene, "--video", video}, options);
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_CONTAINS(result.err, "ffmpeg, which makes videos, is not on the PATH");
  EXPECT_CONTAINS(result.err, "install ffmpeg");
  EXPECT_FALSE(std::filesystem::exists(video));
  EXPECT_EQ(runWeir({"run", scene, "--images", folder / "images"}, options).code, 0) << "pictures need none";
}

TEST_F(PicturesOfRuns, WithoutOpenGlTheRunSaysWhatToInstall) {
  // Files that are found before the libraries, and are none.
  const std::string drivers = folder / "drivers";
  std::filesystem::create_directory(drivers);
  for (const char* library : {"libOSMesa.so.8", "libOSMesa.so.6", "libEGL.so.1", "libEGL.so"})
    folder.write(std::string("drivers/") + library, "no library");
  ChildOptions options;
  options.environment["LD_LIBRARY_PATH"] = drivers;
  const ChildResult result = runWeir({"run", scene, "--images", folder / "images"}, options);
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_CONTAINS(result.err, "no OpenGL context");
  EXPECT_CONTAINS(result.err, "OSMesa: " + drivers + "/libOSMesa.so.8");
  EXPECT_CONTAINS(result.err, "hint: install libegl1");
  EXPECT_EQ(runWeir({"run", scene, "--quiet"}, options).code, 0) << "a run without pictures needs none";
}

TEST_F(PicturesOfRuns, AFullDiskEndsTheRunWithAMessage) {
  const SmallDisk disk("16k");
  if (!disk.isThere()) GTEST_SKIP() << "this user may not mount a file system";
  for (const auto& [option, path] : {std::pair{"--images", disk / "images"}, {"--video", disk / "run.mp4"}}) {
    const ChildResult result = runWeir({"run", scene, option, path, "--duration", "2"});
    EXPECT_EQ(result.code, 5) << option << ": " << result.err;
    EXPECT_CONTAINS(result.err, path);
    EXPECT_CONTAINS(result.err, "No space left on device");
    std::filesystem::remove_all(path);
  }
}

/// A plate beside some water in weightlessness. `plate` and `motion` are parameters.
std::string plateScene(const std::string& plate, const std::string& motion) {
  return R"({
    "weir": 1,
    "world": { "dt": 0.01, "duration": 0.1, "frame_rate": 10, "gravity": [0, 0, 0] },
    "nodes": {
      "block": { "type": "BoxSampler", "params": { "min": [-1, -1, -1], "max": [-0.9, -0.9, -0.9] } },
      "plate": { "type": "BoxMesh", "params": { )" +
         plate + R"( } },
      "motion": { "type": "SemiAnalyticalSFI", "params": { )" +
         motion + R"( } },
      "water": { "type": "ParticleFluid", "params": { "spacing": 0.05 } }
    },
    "links": [ "block.particles -> water.initial", "water.fluid -> motion.fluid",
               "plate.surface -> motion.solids" ],
    "render": { "width": 320, "height": 180, "ground": false,
                "camera": { "eye": [0, 0, 4], "target": [0, 0, 0] } }
  })";
}

/// The share of bytes that differ noticeably.
double difference(const rendering::Picture& a, const rendering::Picture& b) {
  EXPECT_EQ(a.rgb.size(), b.rgb.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < std::min(a.rgb.size(), b.rgb.size()); ++i)
    different += std::abs(int(a.rgb[i]) - int(b.rgb[i])) > 8 ? 1 : 0;
  return double(different) / double(a.rgb.size());
}

TEST_F(PicturesOfRuns, SolidsAreShownWhereTheyMoved) {
  const std::string moving =
      folder.write("moving.json", plateScene(R"("min": [-0.4, -0.15, -0.05], "max": [0.4, 0.15, 0.05])",
                                             R"("velocity": [3, 0, 0], "angular_velocity": [0, 0, 5])"));
  // Where it is after 0.1 s; half a radian is 28.6479 degrees.
  const std::string there = folder.write(
      "there.json",
      plateScene(R"("min": [-0.1, -0.15, -0.05], "max": [0.7, 0.15, 0.05], "rotation": [0, 0, 28.6479])",
                 ""));
  for (const std::string& file : {moving, there}) {
    const ChildResult result = runWeir({"run", file, "--images", file + ".images"});
    ASSERT_EQ(result.code, 0) << result.err;
  }
  const auto frame = [](const std::string& file, int k) {
    return readPng(file + ".images/frame_0000" + std::to_string(k) + ".png");
  };
  EXPECT_LT(difference(frame(moving, 1), frame(there, 1)), 1e-3);
  EXPECT_GT(difference(frame(moving, 0), frame(there, 0)), 0.01);
}

}  // namespace
}  // namespace weir::test
