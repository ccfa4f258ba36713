// Which triangles divide a cube whose corners are inside or outside, made from rules.
//
// Corner c of the cube stands at (c & 1, c >> 1 & 1, c >> 2). Its edge from a corner to the next one along
// an axis has the number 3·corner + axis. On each face the edges that are crossed are joined so that inside
// corners which are not neighbours stay apart. That depends on the face alone, so two cubes that share it
// agree, and what is joined on all faces of a cube is made of closed polygons. Their triangles have no edge
// within a face but the polygon's own, so each edge of the whole surface belongs to two triangles.
#pragma once

#include <array>

#include "framework/base/api.h"

namespace WEIR_API weir {

struct CubeTable {
  static constexpr int kMaxTriangles = 5;

  /// By case: bit c says whether corner c is inside.
  std::array<unsigned char, 256> triangles;
  /// The edges on which the corners of triangle t are: 3t, 3t + 1, 3t + 2; counter-clockwise seen from
  /// outside.
  std::array<std::array<unsigned char, 3 * kMaxTriangles>, 256> edges;
};

CubeTable makeCubeTable();

}  // namespace weir
