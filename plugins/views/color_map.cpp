#include "plugins/views/color_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "framework/base/check.h"

namespace weir::rendering {
namespace {

/// Colours 0xrrggbb at t = i/32.
using Table = std::array<std::uint32_t, 33>;

constexpr Table kViridis{0x440154, 0x470d60, 0x48186a, 0x482374, 0x472d7b, 0x453681, 0x424086,
                         0x3f4989, 0x3b528b, 0x375a8d, 0x33638d, 0x2f6a8e, 0x2c728e, 0x297a8e,
                         0x26818e, 0x23898e, 0x21908c, 0x1f988b, 0x1f9f88, 0x21a685, 0x28ae80,
                         0x31b57b, 0x3ebc74, 0x4cc26c, 0x5dc963, 0x6ece58, 0x82d34c, 0x96d83f,
                         0xabdc32, 0xc0df24, 0xd5e21a, 0xeae51a, 0xfde725};
constexpr Table kTurbo{0x30123b, 0x392a73, 0x4040a1, 0x4456c7, 0x466be3, 0x467ff6, 0x4293ff,
                       0x37a7fa, 0x29bbec, 0x1dcdd8, 0x18dcc3, 0x1ee8b0, 0x31f299, 0x4cf97e,
                       0x6bfd64, 0x8aff4d, 0xa3fd3c, 0xb8f735, 0xcced34, 0xdee037, 0xedd03a,
                       0xf8c03a, 0xfdae35, 0xfe982c, 0xfb8022, 0xf56817, 0xec520f, 0xe04009,
                       0xd23105, 0xc02302, 0xac1701, 0x950d01, 0x7a0403};
constexpr Table kCividis{0x00224e, 0x00285b, 0x002e6a, 0x043371, 0x1a386f, 0x273e6e, 0x32436d,
                         0x3b496c, 0x434e6c, 0x4b546c, 0x52596d, 0x5a5f6e, 0x61656f, 0x686a71,
                         0x6f7073, 0x757676, 0x7c7b78, 0x848179, 0x8b8778, 0x938d78, 0x9b9376,
                         0xa39a75, 0xaba072, 0xb3a670, 0xbbad6c, 0xc3b469, 0xccba64, 0xd4c15f,
                         0xddc958, 0xe6d051, 0xefd748, 0xf8df3c, 0xfee838};
constexpr Table kCoolwarm{0x3b4cc0, 0x445acc, 0x4d68d7, 0x5775e1, 0x6282ea, 0x6c8ef1, 0x779af7,
                          0x82a5fb, 0x8db0fe, 0x98b9ff, 0xa3c2fe, 0xaec9fc, 0xb8d0f9, 0xc2d5f4,
                          0xccd9ee, 0xd5dbe6, 0xdddddd, 0xe5d8d1, 0xecd3c5, 0xf1ccb9, 0xf4c4ad,
                          0xf7bba0, 0xf7b194, 0xf7a687, 0xf49a7b, 0xf18d6f, 0xec7f63, 0xe57058,
                          0xde604d, 0xd55042, 0xcb3e38, 0xc0282f, 0xb40426};

/// Piecewise linear between five colours of growing lightness.
constexpr Table kWater{0x124a94, 0x144f9a, 0x1554a0, 0x1759a6, 0x185eac, 0x1a63b2, 0x1c68b8,
                       0x1d6dbe, 0x1f72c4, 0x2478c8, 0x2a7ecc, 0x2f84cf, 0x348ad3, 0x3a91d7,
                       0x3f97da, 0x459dde, 0x4aa3e2, 0x53a8e4, 0x5daee6, 0x66b3e7, 0x70b8e9,
                       0x79bdeb, 0x82c2ec, 0x8cc8ee, 0x95cdf0, 0xa0d2f2, 0xacd8f3, 0xb7ddf5,
                       0xc2e2f6, 0xcee8f8, 0xd9edfa, 0xe5f3fb, 0xf0f8fd};

constexpr Vec3f kNeutral{0.5f, 0.5f, 0.5f};

const Table& tableOf(ColorMapName map) {
  switch (map) {
    case ColorMapName::kWater:
      return kWater;
    case ColorMapName::kViridis:
      return kViridis;
    case ColorMapName::kTurbo:
      return kTurbo;
    case ColorMapName::kCividis:
      return kCividis;
    case ColorMapName::kCoolwarm:
      break;
  }
  return kCoolwarm;
}

Vec3f unpack(std::uint32_t rgb) {
  return Vec3f{float(rgb >> 16), float((rgb >> 8) & 0xff), float(rgb & 0xff)} / 255.0f;
}

}  // namespace

ColorMap::ColorMap(ColorMapName name) {
  for (const std::uint32_t color : tableOf(name)) colors_.push_back(unpack(color));
}

ColorMap::ColorMap(std::vector<Vec3f> colors) : colors_(std::move(colors)) {
  WEIR_CHECK(colors_.size() >= 2u);
}

Vec3f ColorMap::at(float t) const {
  if (std::isnan(t)) return kNeutral;
  const float place = std::clamp(t, 0.0f, 1.0f) * float(colors_.size() - 1);
  const std::size_t left = std::min(std::size_t(place), colors_.size() - 2);
  const float part = place - float(left);
  return colors_[left] * (1 - part) + colors_[left + 1] * part;
}

}  // namespace weir::rendering
