// --engine cycles and --blender, through the program, with a script in place of Blender. What a real one
// makes of it is tested in tests/plugins/cycles.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScene = R"({
  "weir": 1,
  "world": { "dt": 0.005, "duration": 0.04, "frame_rate": 50, "gravity": [0, 0, 0] },
  "nodes": {
    "ball": { "type": "SphereSampler", "params": { "center": [0, 0.5, 0], "radius": 0.1 } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.04 } }
  },
  "links": [ "ball.particles -> water.initial" ],
  "render": { "width": 48, "height": 32, "overlay": false, "fluids": [ { "node": "water" } ] }
})";
constexpr int kFrames = 3;

/// Answers each request by a copy of a picture, and notes it. `$request` is the line.
constexpr const char* kStandIn = R"sh(#!/bin/sh
while read -r request; do
  target=$(printf '%s' "$request" | sed 's/.*"\(picture\|blend\)": *"\([^"]*\)".*/\2/')
  frame=$(printf '%s' "$request" | sed 's/.*"frame": *"\([^"]*\)".*/\1/')
  basename "$frame" >>"FOLDER/asked"
  test -s "$frame" || exit 3
  EXTRA
  cp "FOLDER/picture.png" "$target.copy" && mv "$target.copy" "$target"
done
)sh";

class CyclesOfRuns : public testing::Test {
 protected:
  void SetUp() override {
    scene_ = folder.write("scene.json", kScene);
    const ChildResult drawn =
        runWeir({"run", scene_, "--quiet", "--frames", "0", "--images", folder / "drawn"});
    ASSERT_EQ(drawn.code, 0) << drawn.err;
    fs::copy_file(folder / "drawn/frame_00000.png", folder / "picture.png");
    standIn("");
  }

  /// `extra` is a command of the shell that is run before each picture.
  void standIn(const std::string& extra) {
    std::string text = kStandIn;
    for (const auto& [name, value] :
         {std::pair<std::string, std::string>{"FOLDER", folder.path()}, {"EXTRA", extra}})
      for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + value.size()))
        text.replace(at, name.size(), value);
    fs::permissions(folder.write("blender", text), fs::perms::owner_all);
  }

  ChildResult run(const std::vector<std::string>& outputs, const std::string& blender) const {
    std::vector<std::string> arguments{"run", scene_, "--device", "cpu"};
    arguments.insert(arguments.end(), outputs.begin(), outputs.end());
    return runWeir(arguments, {.environment = {{"WEIR_BLENDER", blender}}});
  }
  ChildResult draw() const {
    return run({"--engine", "cycles", "--images", folder / "images"}, folder / "blender");
  }

  /// The names of the frames that the stand-in was asked for, a line each.
  std::string asked() const { return readFile(folder / "asked"); }

  std::vector<std::string> filesIn(const std::string& name) const {
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(folder / name))
      files.push_back(entry.path().filename().string());
    std::sort(files.begin(), files.end());
    return files;
  }

  const TemporaryFolder folder;
  std::string scene_;
};

TEST_F(CyclesOfRuns, BlenderDrawsEachFrameOnce) {
  const ChildResult first = draw();
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(asked(), "frame_00000.npz\nframe_00001.npz\nframe_00002.npz\n");
  for (int frame = 0; frame < kFrames; ++frame)
    EXPECT_TRUE(fs::exists(folder / "images/frame_0000" + std::to_string(frame) + ".png"));
  fs::remove(folder / "images/frame_00001.png");
  fs::remove(folder / "asked");
  const ChildResult again = draw();
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_CONTAINS(again.err, "2 pictures were there and have not been drawn again");
  EXPECT_EQ(asked(), "frame_00001.npz\n");
  EXPECT_TRUE(fs::exists(folder / "images/frame_00001.png"));
}

TEST_F(CyclesOfRuns, WhatBlenderSaysWhenItFailsIsSaid) {
  standIn("echo 'weir: there is no room' >&2; exit 1");
  const ChildResult result = draw();
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_CONTAINS(result.err, "Blender (blender) ended with exit code 1: there is no room");
  EXPECT_FALSE(fs::exists(folder / "images/frame_00000.png"));
}

TEST_F(CyclesOfRuns, AnInterruptionDoesNotWaitForBlender) {
  standIn("kill -INT $PPID; exec sleep 100");
  const ChildResult result =
      runWeir({"run", scene_, "--device", "cpu", "--engine", "cycles", "--images", folder / "images"},
              {.environment = {{"WEIR_BLENDER", folder / "blender"}},
               .folder = {},
               .limit = std::chrono::seconds(60)});
  EXPECT_EQ(result.code, 130) << result.err;
  EXPECT_EQ(filesIn("images"), std::vector<std::string>{"frames.txt"});
}

TEST_F(CyclesOfRuns, WithoutBlenderTheWayToItIsSaid) {
  const ChildResult wrong = run({"--engine", "cycles", "--images", folder / "images"}, folder / "none");
  EXPECT_EQ(wrong.code, 5);
  EXPECT_CONTAINS(wrong.err, "WEIR_BLENDER names");
  EXPECT_CONTAINS(wrong.err, "pip install bpy");
  // Nothing on the PATH.
  const ChildResult none =
      runWeir({"run", scene_, "--device", "cpu", "--engine", "cycles", "--images", folder / "images"},
              {.environment = {{"WEIR_BLENDER", ""}, {"PATH", folder.path() + "/nowhere"}}});
  EXPECT_EQ(none.code, 5);
  EXPECT_CONTAINS(none.err, "there is no Blender here");
  EXPECT_CONTAINS(none.err, "apt install blender");
  const ChildResult engine = run({"--engine", "povray", "--images", folder / "images"}, "");
  EXPECT_EQ(engine.code, 2);
  EXPECT_CONTAINS(engine.err, "povray");
}

TEST_F(CyclesOfRuns, TheFolderForBlenderHoldsAllFrames) {
  const ChildResult result = run({"--blender", folder / "run"}, folder / "blender");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(filesIn("run"), (std::vector<std::string>{"frame_00000.npz", "frame_00001.npz", "frame_00002.npz",
                                                      "scene.blend"}));
  // A zip archive, whose arrays are not compressed: the surface of the water, though nobody asked for one.
  const std::string frame = readFile(folder / "run/frame_00002.npz");
  EXPECT_TRUE(frame.starts_with("PK\x03\x04"));
  EXPECT_CONTAINS(frame, "surface0_vertices.npy");
  EXPECT_CONTAINS(frame, "\"refractive_index\": 1.33");
  // Without Blender it is there all the same.
  const ChildResult without = run({"--blender", folder / "other"}, folder / "none");
  EXPECT_EQ(without.code, 0) << without.err;
  EXPECT_CONTAINS(without.err, "scene.blend was not made");
  EXPECT_EQ(filesIn("other").size(), std::size_t{kFrames});
}

}  // namespace
}  // namespace weir::test
