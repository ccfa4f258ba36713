#include "plugins/views/color_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace weir::rendering {
namespace {

struct Published {
  ColorMapName map;
  float t;
  int r, g, b;
};

TEST(ColorMap, HasThePublishedColors) {
  // Entries of the authors' own tables of 256 colours, none of them a control colour of ours but the ends.
  const Published entries[] = {
      {ColorMapName::kViridis, 0, 68, 1, 84},         {ColorMapName::kViridis, 1, 253, 231, 37},
      {ColorMapName::kViridis, 0.5f, 33, 145, 140},   {ColorMapName::kTurbo, 0, 48, 18, 59},
      {ColorMapName::kTurbo, 1, 122, 4, 3},           {ColorMapName::kTurbo, 0.5f, 163, 253, 60},
      {ColorMapName::kCividis, 0, 0, 34, 78},         {ColorMapName::kCividis, 1, 254, 232, 56},
      {ColorMapName::kCividis, 0.5f, 124, 123, 120},  {ColorMapName::kCoolwarm, 0, 59, 76, 192},
      {ColorMapName::kCoolwarm, 0.5f, 221, 221, 221}, {ColorMapName::kCoolwarm, 1, 180, 4, 38},
  };
  for (const Published& entry : entries) {
    const Vec3f color = ColorMap(entry.map).at(entry.t) * 255.0f;
    EXPECT_NEAR(color.x, entry.r, 3) << int(entry.map) << " at " << entry.t;
    EXPECT_NEAR(color.y, entry.g, 3) << int(entry.map) << " at " << entry.t;
    EXPECT_NEAR(color.z, entry.b, 3) << int(entry.map) << " at " << entry.t;
  }
}

TEST(ColorMap, LightnessOfViridisAndCividisOnlyGrows) {
  for (const ColorMapName map : {ColorMapName::kViridis, ColorMapName::kCividis}) {
    double before = -1;
    for (int i = 0; i <= 100; ++i) {
      const Vec3f color = ColorMap(map).at(float(i) / 100);
      const double luminance =
          0.2126 * std::pow(color.x, 2.2) + 0.7152 * std::pow(color.y, 2.2) + 0.0722 * std::pow(color.z, 2.2);
      EXPECT_GT(luminance, before) << i;
      before = luminance;
    }
  }
}

TEST(ColorMap, ValuesOutsideHaveTheColorsOfTheEnds) {
  for (const ColorMapName map : {ColorMapName::kViridis, ColorMapName::kTurbo}) {
    EXPECT_EQ(ColorMap(map).at(-7), ColorMap(map).at(0));
    EXPECT_EQ(ColorMap(map).at(std::numeric_limits<float>::infinity()), ColorMap(map).at(1));
    EXPECT_EQ(ColorMap(map).at(std::nanf("")), (Vec3f{0.5f, 0.5f, 0.5f}));
  }
}

}  // namespace
}  // namespace weir::rendering
