// The contents of mesh files.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "framework/geometry/dynamic_mesh_copy.h"

namespace weir {

/// Stanford PLY, binary and little-endian: vertices with x, y, z and nx, ny, nz as floats, and triangles as
/// lists of three ints.
std::string plyOf(const MeshSpan& mesh);

/// Wavefront OBJ: v, vn and f lines, numbers with as many digits as floats need to be the same again.
std::string objOf(const MeshSpan& mesh);

/// One property of the vertices of a PLY file, and its numbers.
struct PlyColumn {
  std::string name;
  /// Written as float, int, and double, as PLY has no longer ints: exact below 2⁵³.
  std::variant<std::span<const float>, std::span<const std::int32_t>, std::span<const std::int64_t>> numbers;
  int stride = 1;  ///< numbers of one vertex
  int first = 0;   ///< which of them it is
};

/// A PLY file of `count` points, binary and little-endian, with the columns in this order. Names hold no
/// white space.
std::string plyOf(std::int64_t count, const std::vector<PlyColumn>& columns);

}  // namespace weir
