#include "plugins/rendering/overlay/overlay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "framework/base/error.h"
#include "tests/support/child_process.h"

namespace weir::rendering {
namespace {

std::filesystem::path fonts() {
  return test::buildFolder() + "/share/weir/fonts";
}

Picture greyPicture(int width, int height) {
  return {width, height, std::vector<std::uint8_t>(3 * std::size_t(width) * std::size_t(height), 200)};
}

/// The box around the pixels that are darker than the grey ones, or lighter.
struct Ink {
  int left = 1 << 20, top = 1 << 20, right = -1, bottom = -1;
};
Ink inkOf(const Picture& picture, bool light) {
  Ink ink;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const int red = picture.rgb[3 * (std::size_t(y) * std::size_t(picture.width) + std::size_t(x))];
      if (light ? red < 235 : red > 120) continue;
      ink.left = std::min(ink.left, x), ink.right = std::max(ink.right, x);
      ink.top = std::min(ink.top, y), ink.bottom = std::max(ink.bottom, y);
    }
  return ink;
}

TEST(Overlay, TitleStandsInTheUpperLeftAndGrowsWithThePicture) {
  Overlay overlay(fonts());
  Picture small = greyPicture(1280, 720), large = greyPicture(2560, 1440);
  overlay.draw({.title = "Water"}, small);
  overlay.draw({.title = "Water"}, large);
  const Ink a = inkOf(small, false), b = inkOf(large, false);
  EXPECT_GT(a.right, a.left + 50);
  EXPECT_LT(a.right, 200);
  EXPECT_LT(a.bottom, 80);
  EXPECT_NEAR(b.right - b.left, 2 * (a.right - a.left), 6);
  EXPECT_NEAR(b.top, 2 * a.top, 4);
}

TEST(Overlay, LinesStandBelowEachOther) {
  Overlay overlay(fonts());
  int bottom = 0;
  OverlayText text;
  for (int lines = 1; lines <= 3; ++lines) {
    if (lines == 1) text.title = "Water";
    if (lines == 2) text.seconds = 1.25;
    if (lines == 3) text.particles = 1000;
    Picture picture = greyPicture(1280, 720);
    overlay.draw(text, picture);
    const int now = inkOf(picture, false).bottom;
    EXPECT_GT(now, bottom + 8);
    bottom = now;
  }
}

TEST(Overlay, BarShowsTheColorsOfTheMap) {
  Overlay overlay(fonts());
  Picture picture = greyPicture(1280, 720);
  overlay.draw({.bar = ColorBar{ColorMapName::kTurbo, 0, 4, "speed in m/s"}}, picture);
  // Down the bar's middle, the colours go from the map's end to its beginning.
  const int x = 1280 - 28 - 7;
  std::vector<Vec3f> column;
  for (int y = 0; y < 720; ++y) {
    const std::uint8_t* p = &picture.rgb[3 * (std::size_t(y) * 1280 + x)];
    column.push_back(Vec3f{float(p[0]), float(p[1]), float(p[2])} / 255.0f);
  }
  const auto rowOf = [&](const Vec3f& color) {
    int best = 0;
    for (int y = 1; y < 720; ++y)
      if (length(column[y] - color) < length(column[best] - color)) best = y;
    EXPECT_LT(length(column[best] - color), 0.03f);
    return best;
  };
  const int top = rowOf(ColorMap(ColorMapName::kTurbo).at(0.998f)),
            bottom = rowOf(ColorMap(ColorMapName::kTurbo).at(0.002f));
  EXPECT_EQ(bottom - top, 259);
  EXPECT_NEAR(rowOf(ColorMap(ColorMapName::kTurbo).at(0.25f)), top + 0.75 * 259, 2);
}

TEST(Overlay, LightTextOnDark) {
  EXPECT_FALSE(wantsLightText({0.78f, 0.84f, 0.9f, 1}, {0.95f, 0.96f, 0.97f, 1}));
  EXPECT_TRUE(wantsLightText({0.05f, 0.05f, 0.1f, 1}, {0.2f, 0.2f, 0.25f, 1}));
  Overlay overlay(fonts());
  Picture picture = greyPicture(640, 360);
  overlay.draw({.title = "Water", .lightText = true}, picture);
  EXPECT_GT(inkOf(picture, true).right, 20);
}

TEST(Overlay, TinyAndFlatPicturesCutTheTextOff) {
  Overlay overlay(fonts());
  for (const auto& [width, height] :
       {std::pair{16, 16}, std::pair{1, 1}, std::pair{16, 2000}, std::pair{2000, 16}}) {
    Picture picture = greyPicture(width, height);
    const std::size_t size = picture.rgb.size();
    overlay.draw({.title = "A long title that is wider than the picture",
                  .seconds = -1e300,
                  .particles = 1 << 30,
                  .bar = ColorBar{ColorMapName::kTurbo, 1, 1, "λ in m/s"}},
                 picture);
    EXPECT_EQ(picture.rgb.size(), size);
  }
}

TEST(Font, MasksAreAsWideAsTheirLetters) {
  Font font(fonts() / "DejaVuSans.ttf");
  EXPECT_GT(font.write("MMMM", 20).width, 2 * font.write("iiii", 20).width);
  EXPECT_EQ(font.write("Mg", 20).height, font.write(".", 20).height);
  EXPECT_EQ(font.write("", 20).width, 3);  // the room at both ends
}

TEST(Font, MissingFilesAreErrors) {
  EXPECT_THROW(Font("/nowhere/font.ttf"), Error);
  EXPECT_THROW(Overlay("/nowhere"), Error);
}

TEST(Font, ReadsUtf8) {
  EXPECT_EQ(charactersOf("a³λ€😀"), (std::vector<char32_t>{U'a', U'³', U'λ', U'€', U'😀'}));
  EXPECT_EQ(charactersOf("a\xff\xc3"), (std::vector<char32_t>{U'a', 0xfffd, 0xfffd}));
}

}  // namespace
}  // namespace weir::rendering
