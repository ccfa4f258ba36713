// Transparent pictures, colours and surroundings from files, and surfaces that look like water, through the
// program.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "plugins/video/image_file.h"
#include "tests/plugins/video/video_tools.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

using rendering::Picture;

/// A ball of particles, and what RENDER says. The picture's middle is the ball's.
constexpr const char* kBall = R"({
  "weir": 1,
  "world": { "dt": 0.005, "duration": 0.02, "frame_rate": 50, "gravity": [0, 0, 0] },
  "nodes": {
    "ball": { "type": "SphereSampler", "params": { "center": [0, 0.5, 0], "radius": 0.2 } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.04 } }
    NODES
  },
  "links": [ "ball.particles -> water.initial" LINKS ],
  "render": { "width": 160, "height": 120, "overlay": false,
              "camera": { "eye": [0, 0.5, 1.6], "target": [0, 0.5, 0] },
              RENDER }
})";

class LooksOfRuns : public testing::Test {
 protected:
  const TemporaryFolder folder;

  std::string scene(const std::string& render, const std::string& nodes = {}, const std::string& links = {}) {
    std::string text = kBall;
    text.replace(text.find("RENDER"), 6, render);
    text.replace(text.find("NODES"), 5, nodes);
    text.replace(text.find("LINKS"), 5, links);
    return folder.write("scene.json", text);
  }
  ChildResult run(const std::string& render, const std::vector<std::string>& outputs) {
    std::vector<std::string> arguments{"run", scene(render), "--quiet", "--frames", "0"};
    arguments.insert(arguments.end(), outputs.begin(), outputs.end());
    return runWeir(arguments);
  }
  /// Frame 0.
  Picture draw(const std::string& render) {
    const ChildResult result = run(render, {"--images", folder / "images"});
    EXPECT_EQ(result.code, 0) << result.err;
    return result.code == 0 ? rendering::readPng(folder / "images/frame_00000.png") : Picture{};
  }
  std::string errorOf(const std::string& render, int code) {
    const ChildResult result = run(render, {"--images", folder / "images"});
    EXPECT_EQ(result.code, code) << result.err;
    return result.err;
  }
};

struct Pixel {
  int red, green, blue, alpha;
};

Pixel at(const Picture& picture, int x, int y) {
  const std::size_t place = static_cast<std::size_t>(y * picture.width + x);
  return {picture.rgb[3 * place], picture.rgb[3 * place + 1], picture.rgb[3 * place + 2],
          picture.alpha.empty() ? 255 : picture.alpha[place]};
}

double linear(int byte) {
  const double s = byte / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}
int encoded(double light) {
  return static_cast<int>(
      std::lround(255 * (light < 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055)));
}

TEST_F(LooksOfRuns, TransparentPicturesOverBlackAreThoseBeforeBlack) {
  const std::string black = R"("ground": false, "background_top": [0, 0, 0], "background_bottom": [0, 0, 0])";
  for (const std::string look : {R"(, "color": { "bar": false })", R"(, "fluids": [{ "node": "water" }])"}) {
    const Picture opaque = draw(black + look), clear = draw(black + look + R"(, "transparent": true)");
    ASSERT_EQ(clear.alpha.size(), 160u * 120u);
    EXPECT_TRUE(opaque.alpha.empty());
    EXPECT_EQ(at(clear, 2, 2).alpha, 0);
    int edges = 0, wrong = 0;
    for (int y = 0; y < clear.height; ++y)
      for (int x = 0; x < clear.width; ++x) {
        const Pixel a = at(clear, x, y), b = at(opaque, x, y);
        edges += a.alpha > 20 && a.alpha < 235;
        // Dark colours of nearly transparent pixels are coarse.
        const int found = encoded(linear(a.green) * a.alpha / 255.0);
        wrong += std::abs(found - b.green) > 4;
      }
    EXPECT_GT(edges, 50) << "outlines are smooth";
    EXPECT_EQ(wrong, 0) << look;
  }
  EXPECT_EQ(at(draw(black + R"(, "transparent": true, "color": { "bar": false })"), 80, 60).alpha, 255);
}

TEST_F(LooksOfRuns, TransparentPicturesKeepTheShadowOfTheGround) {
  const std::string above = R"("transparent": true, "color": { "bar": false }, "cameras": [
    { "name": "above", "eye": [0, 3, 0.4], "target": [0, 0.2, 0] }])";
  const auto shadow = [&](const std::string& ground) {
    draw(above + ground);
    const Picture picture = rendering::readPng(folder / "images/above/frame_00000.png");
    int dark = 0;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const Pixel pixel = at(picture, x, y);
        dark += pixel.alpha > 40 && pixel.red + pixel.green + pixel.blue < 10;
      }
    return dark;
  };
  EXPECT_GT(shadow(""), 100);
  EXPECT_LT(shadow(R"(, "ground": false)"), 5);
}

TEST_F(LooksOfRuns, TransparentVideosNeedACodecThatCan) {
  const ChildResult mp4 = run(R"("transparent": true)", {"--video", folder / "run.mp4"});
  EXPECT_EQ(mp4.code, 3);
  EXPECT_CONTAINS(mp4.err, "/render/video/codec");
  EXPECT_CONTAINS(mp4.err, "ProRes in .mov");
  const ChildResult mov = run(R"("transparent": true)", {"--video", folder / "run.mov"});
  ASSERT_EQ(mov.code, 0) << mov.err;
  EXPECT_EQ(probeVideo(folder / "run.mov").pixelFormat, "yuva444p12le");
}

TEST_F(LooksOfRuns, ColoursComeFromAFile) {
  // Speed is 0 everywhere, the lower end of the range.
  const auto colorWith = [&](const std::string& file) {
    return R"("ground": false, "color": { "bar": false, "range": [0, 1], "file": ")" + file + R"(" })";
  };
  folder.write("ends.csv", "red,green,blue\n# from red to blue\n1,0,0\n0, 0, 1\n");
  folder.write("bytes.csv", "255;0;0\n0;0;255\n");
  folder.write("values.csv", "0,1,0,0\n1,1,0,0\n10,0,0,1\n");
  folder.write("preset.json",
               R"([{ "Name": "mine", "ColorSpace": "RGB", "RGBPoints": [0, 1, 0, 0, 2, 0, 0, 1] }])");
  const Picture first = draw(colorWith("ends.csv"));
  const Pixel middle = at(first, 80, 60);
  EXPECT_GT(middle.red, 4 * middle.blue + 50);
  for (const std::string other : {"bytes.csv", "values.csv", "preset.json"})
    EXPECT_EQ(draw(colorWith(other)).rgb, first.rgb) << other;
  const Picture viridis = draw(R"("ground": false, "color": { "bar": false, "range": [0, 1] })");
  EXPECT_NE(viridis.rgb, first.rgb);

  folder.write("word.csv", "1,0,0\n0,0,blue\n");
  EXPECT_CONTAINS(errorOf(colorWith("word.csv"), 5), "word.csv:2");
  folder.write("two.csv", "1,0\n0,0\n");
  EXPECT_CONTAINS(errorOf(colorWith("two.csv"), 5), "red, green and blue, or a value, red, green and blue");
  folder.write("one.csv", "1,0,0\n");
  EXPECT_CONTAINS(errorOf(colorWith("one.csv"), 5), "the colour map has 1 colours");
  folder.write("large.csv", "1,0,0\n300,0,0\n");
  EXPECT_CONTAINS(errorOf(colorWith("large.csv"), 5), "component 300");
  folder.write("falls.csv", "1,1,0,0\n0,0,0,1\n");
  EXPECT_CONTAINS(errorOf(colorWith("falls.csv"), 5), "not above the one before");
  folder.write("other.json", R"({ "hello": 1 })");
  EXPECT_CONTAINS(errorOf(colorWith("other.json"), 5), "RGBPoints");
  EXPECT_CONTAINS(errorOf(colorWith("map.xml"), 5), ".csv or .json");
  EXPECT_CONTAINS(errorOf(colorWith("nowhere.csv"), 5), "nowhere.csv");
  EXPECT_CONTAINS(errorOf(R"("color": { "file": "ends.csv", "table": [[0, 0, 0], [1, 1, 1]] })", 3),
                  "one of them");
}

/// A Radiance picture without compression, of the light that `lightOf` gives for each pixel, upper row first.
template <class F>
std::string radiance(int width, int height, F lightOf) {
  std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " +
                      std::to_string(width) + "\n";
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::array<double, 3> light = lightOf(x, y);
      int exponent = 0;
      std::frexp(std::max({light[0], light[1], light[2], 1e-9}), &exponent);
      for (const double part : light) bytes += static_cast<char>(std::ldexp(part, 8 - exponent));
      bytes += static_cast<char>(exponent + 128);
    }
  return bytes;
}

std::string plainRadiance(std::array<double, 3> light) {
  return radiance(8, 4, [&](int, int) { return light; });
}

std::string surroundedBy(const std::string& file, const std::string& more = {}) {
  return R"("ground": false, "environment": { "look": "image", "sun_strength": 0, "image": ")" + file + "\"" +
         more + " }";
}

TEST_F(LooksOfRuns, SurroundingsOfOneColourLightMattThings) {
  folder.write("plain.hdr", plainRadiance({0.5, 0.25, 0.125}));
  const std::string white = R"(, "color": { "by": "none", "fixed": [1, 1, 1] })";
  const Picture picture = draw(surroundedBy("plain.hdr") + white);
  // White shows the light that it gets from all sides, but for what neighbours hide and what rims mirror.
  const Pixel corner = at(picture, 2, 2), ball = at(picture, 80, 60);
  EXPECT_NEAR(corner.red, encoded(0.5), 2);
  EXPECT_NEAR(corner.green, encoded(0.25), 2);
  EXPECT_NEAR(corner.blue, encoded(0.125), 2);
  EXPECT_NEAR(linear(ball.green) / linear(ball.red), 0.5, 0.04);
  EXPECT_GT(linear(ball.red), 0.2);
  EXPECT_LT(linear(ball.red), 0.65);
  // The same in run lengths: of each line, channel by channel.
  std::string runs = plainRadiance({0.5, 0.25, 0.125}).substr(0, 45);
  const std::string pixel = plainRadiance({0.5, 0.25, 0.125}).substr(45, 4);
  ASSERT_EQ(runs.back(), '\n');
  for (int y = 0; y < 4; ++y) {
    runs += std::string("\2\2\0\10", 4);
    for (const char channel : pixel) runs += std::string(1, '\x88') + channel;
  }
  folder.write("runs.hdr", runs);
  EXPECT_EQ(draw(surroundedBy("runs.hdr") + white).rgb, picture.rgb);
  const Picture brighter = draw(surroundedBy("plain.hdr", R"(, "brightness": 0.5)") + white);
  EXPECT_NEAR(linear(at(brighter, 80, 60).red), 0.5 * linear(ball.red), 0.02);
  const Picture hidden = draw(surroundedBy("plain.hdr", R"(, "background": false)") + white);
  EXPECT_GT(at(hidden, 2, 2).blue, 180) << "the plain background";
  EXPECT_EQ(at(hidden, 80, 60).red, ball.red);
}

TEST_F(LooksOfRuns, SurroundingsStandTheRightWayRound) {
  // Looked at along -z: red to the left, green to the right, blue above; behind the camera it is dark.
  folder.write(
      "sides.hdr", radiance(64, 32, [](int x, int y) -> std::array<double, 3> {
        const bool above = y<12, ahead = x> 12 && x < 52;
        if (!ahead) return {0.01, 0.01, 0.01};
        if (above) return {0.01, 0.01, 0.8};
        return x < 32 ? std::array<double, 3>{0.8, 0.01, 0.01} : std::array<double, 3>{0.01, 0.8, 0.01};
      }));
  const std::string nothing =
      R"(, "particles": "none", "camera": { "eye": [0, 0.5, 1.6], "target": [0, 0.5, 0], "fov": 80 })";
  std::string render = surroundedBy("sides.hdr") + nothing;
  const auto drawWide = [&](const std::string& text) {
    std::string scene = this->scene(text);
    std::string all = readFile(scene);
    const std::string first = R"("camera": { "eye": [0, 0.5, 1.6], "target": [0, 0.5, 0] },)";
    all.replace(all.find(first), first.size(), "");
    scene = folder.write("wide.json", all);
    const ChildResult result =
        runWeir({"run", scene, "--quiet", "--frames", "0", "--images", folder / "wide"});
    EXPECT_EQ(result.code, 0) << result.err;
    return rendering::readPng(folder / "wide/frame_00000.png");
  };
  const Picture picture = drawWide(render);
  const Pixel left = at(picture, 40, 70), right = at(picture, 120, 70), above = at(picture, 80, 5);
  EXPECT_GT(left.red, 4 * left.green);
  EXPECT_GT(right.green, 4 * right.red);
  EXPECT_GT(above.blue, 4 * above.red);
  // Turned to its left by a quarter: what was to the right is ahead.
  const Picture turned = drawWide(surroundedBy("sides.hdr", R"(, "turn": 30)") + nothing);
  const Pixel ahead = at(turned, 80, 70);
  EXPECT_GT(ahead.green, 4 * ahead.red);
}

TEST_F(LooksOfRuns, WaterMirrorsAndBendsTheSurroundings) {
  folder.write("red.hdr", plainRadiance({0.6, 0.02, 0.02}));
  folder.write("green.hdr", plainRadiance({0.02, 0.6, 0.02}));
  const std::string water = R"(, "fluids": [{ "node": "water" }])";
  const Pixel red = at(draw(surroundedBy("red.hdr") + water), 80, 60);
  const Pixel green = at(draw(surroundedBy("green.hdr") + water), 80, 60);
  EXPECT_GT(red.red, red.green);
  EXPECT_GT(green.green, 2 * green.red);
}

TEST_F(LooksOfRuns, WrongSurroundingsAreErrors) {
  folder.write("none.hdr", "no picture");
  EXPECT_CONTAINS(errorOf(surroundedBy("none.hdr"), 5), "this is not a Radiance picture");
  folder.write("square.hdr", radiance(4, 4, [](int, int) { return std::array<double, 3>{1, 1, 1}; }));
  EXPECT_CONTAINS(errorOf(surroundedBy("square.hdr"), 5), "4 x 4 pixels");
  folder.write("cut.hdr", plainRadiance({1, 1, 1}).substr(0, 60));
  EXPECT_CONTAINS(errorOf(surroundedBy("cut.hdr"), 5), "ends before its last pixel");
  EXPECT_CONTAINS(errorOf(surroundedBy("nowhere.hdr"), 5), "nowhere.hdr");
  EXPECT_CONTAINS(errorOf(R"("environment": { "look": "image" })", 3), "/render/environment/look");
  EXPECT_CONTAINS(errorOf(R"("environment": { "image": "red.hdr" })", 3), "\"look\": \"image\"");
}

TEST_F(LooksOfRuns, TheSurfaceOfAFluidLooksLikeWater) {
  // The ground is seen through a clear surface, and a dark one hides it.
  const auto surface = [&](const std::string& name, const std::string& absorption) {
    const std::string file =
        scene(R"("surfaces": [{ "node": "skin", "look": "water",
        "water": { "scattering": 0, "absorption": )" +
                  absorption + " } }]",
              R"(, "skin": { "type": "FluidSurface" })", R"(, "water.fluid -> skin.fluid")");
    const ChildResult result = runWeir({"run", file, "--quiet", "--frames", "0", "--images", folder / name});
    EXPECT_EQ(result.code, 0) << result.err;
    return at(rendering::readPng(folder / name + "/frame_00000.png"), 80, 60);
  };
  const Pixel clear = surface("clear", "[0, 0, 0]"), dark = surface("dark", "[60, 60, 0]");
  EXPECT_GT(clear.red, 130);
  EXPECT_LT(dark.red, clear.red / 2);
  EXPECT_GT(dark.blue, 2 * dark.red);
}

TEST_F(LooksOfRuns, TheSurfaceOfAFluidHasTheColoursOfItsParticles) {
  // A ball that rests and one that moves, beside both in one colour, red and then blue.
  const std::string nodes = R"(, "skin": { "type": "FluidSurface" }, "other": { "type": "SphereSampler",
      "params": { "center": [0.6, 0.5, 0], "radius": 0.2, "velocity": [0, 0, 1] } })";
  const std::string links = R"(, "water.fluid -> skin.fluid", "other.particles -> water.initial")";
  const auto picture = [&](const std::string& name, const std::string& look) {
    const std::string file = scene(
        R"("color": { "by": "speed", "range": [0, 1], "table": ["#ff0000", "#0000ff"], "bar": false },
           "surfaces": [{ "node": "skin", )" +
            look + "}]",
        nodes, links);
    const ChildResult result = runWeir({"run", file, "--quiet", "--frames", "0", "--images", folder / name});
    EXPECT_EQ(result.code, 0) << result.err;
    return rendering::readPng(folder / name + "/frame_00000.png");
  };
  const Picture both = picture("both", R"("particle_colors": true)");
  const Picture red = picture("red", R"("color": "#ff0000")"),
                blue = picture("blue", R"("color": "#0000ff")");
  const auto expectSame = [](const Pixel& a, const Pixel& b) {
    EXPECT_NEAR(a.red, b.red, 2);
    EXPECT_NEAR(a.green, b.green, 2);
    EXPECT_NEAR(a.blue, b.blue, 2);
  };
  constexpr int kOther = 142;  // px, of its middle
  EXPECT_GT(at(red, 80, 60).red, 2 * at(red, 80, 60).blue);
  EXPECT_GT(at(blue, kOther, 60).blue, 2 * at(blue, kOther, 60).red);
  expectSame(at(both, 80, 60), at(red, 80, 60));
  expectSame(at(both, kOther, 60), at(blue, kOther, 60));
}

}  // namespace
}  // namespace weir::test
