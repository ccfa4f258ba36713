// What a VTKHDF export of particles or surfaces holds: the layout that is fixed when the file is made, and
// one frame.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "framework/base/vec.h"

namespace weir {

enum class VtkHdfType { kFloat32, kInt32, kInt64, kUint32 };

/// One array of the file's PointData. Names are unique and hold no '/'.
struct VtkHdfAttribute {
  std::string name;
  int components = 1;
  VtkHdfType type = VtkHdfType::kFloat32;
  std::string unit;  ///< "m/s"; may be empty
};

struct VtkHdfLayout {
  std::vector<VtkHdfAttribute> attributes;
  std::vector<std::string> fields;  ///< one number a frame each, in the file's FieldData
  bool triangles = false;           ///< the points are vertices of triangles, and no cells of their own
  bool roundPositions = false;      ///< they are round numbers, which compress well
};

/// What stands in the group /simulation of an export, by name.
using ExportTexts = std::vector<std::pair<std::string, std::string>>;

/// Values of one attribute, particle by particle: particles × components numbers.
using VtkHdfValues = std::variant<std::span<const float>, std::span<const std::int32_t>,
                                  std::span<const std::int64_t>, std::span<const std::uint32_t>>;

/// The three components of each vector in a row.
inline VtkHdfValues flat(std::span<const Vec3f> vectors) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  return std::span<const float>(reinterpret_cast<const float*>(vectors.data()), vectors.size() * 3);
}

/// Attributes and fields stand in the order of the layout and have its types.
struct VtkHdfFrame {
  double time = 0;                   ///< s; later than the frame before
  std::span<const Vec3f> positions;  ///< m
  std::vector<VtkHdfValues> attributes;
  std::vector<double> fields;
  std::span<const Vec3i> triangles;  ///< indices of points; none if the layout has none
};

}  // namespace weir
