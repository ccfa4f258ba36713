// Signed distance to a triangle mesh, on a sparse grid that both back ends can query.
//
// Near the surface, bricks of 8³ cells hold exact distances at their nodes; elsewhere a coarse grid with
// nodes at the corners of the bricks does. Between nodes values are interpolated. Outside the grid, the
// distance goes on growing with the distance to the grid. The sign comes from the generalised winding number
// (Jacobson et al. 2013, evaluated by dipoles as in Barill et al. 2018), so small holes do not flip it.
#pragma once

#include <string>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/array.h"
#include "framework/geometry/shapes.h"
#include "framework/geometry/triangle_mesh.h"

namespace WEIR_API weir {

struct MeshSdfView {
  static constexpr int kBrick = 8;           // cells along the edge of a brick
  static constexpr int kNodes = kBrick + 1;  // nodes along the edge of a brick

  Vec3f origin;
  float cellSize = 1;
  Vec3i bricks;                     ///< along each axis
  const float* coarse = nullptr;    ///< (bricks + 1) nodes along each axis
  const int* brickIndex = nullptr;  ///< index of a brick's nodes, or -1 if it has none
  const float* nodes = nullptr;     ///< kNodes³ for each brick that has nodes
  bool inverted = false;            ///< the solid is all that is outside the mesh

  WEIR_HD SignedDistance query(const Vec3f& p) const;
};

class MeshSdf {
 public:
  /// The largest grid in bytes; the coarse grid may be an eighth of it.
  static constexpr std::int64_t kMaxBytes = std::int64_t{2} << 30;

  /// Builds on the host's cores, then copies to the device. `cellSize` in m; all cells that are within `band`
  /// m of the surface have exact distances at their corners, and the grid reaches further beyond the mesh
  /// than that. Where a brick meets the coarse grid, which happens beyond the band only, the distance jumps
  /// by no more than (kBrick + 1)/√2 cells, and by far less where the surface is flat.
  ///
  /// A mesh that is inside out is turned; small holes are closed over by the winding number. Throws a scene
  /// Error if the mesh is empty, too far from the origin for its cell size, or the grid would be too large.
  /// Says in `warnings` what was wrong with the mesh, and whether no point of the grid lies inside it.
  MeshSdf(Device& device, const TriangleMesh& mesh, float cellSize, float band,
          std::vector<std::string>& warnings);

  /// Bytes on the device that such a grid takes at most. Of a surface that is rough on the scale of the cells
  /// it is an estimate, as it counts bricks by the area.
  static double maxMemory(const TriangleMesh& mesh, float cellSize, float band);

  MeshSdfView view(bool inverted) const;

 private:
  MeshSdfView layout_;
  Array<float> coarse_, nodes_;
  Array<int> brickIndex_;
};

namespace detail {

/// Value and gradient (per cell) of trilinear interpolation between the 8 corners of a cell, at t in [0, 1]³.
struct Interpolated {
  float value;
  Vec3f gradient;
};

WEIR_HD inline Interpolated trilinear(const float* corner, int strideY, int strideZ, const Vec3f& t) {
  const float c000 = corner[0], c100 = corner[1], c010 = corner[strideY], c110 = corner[strideY + 1];
  const float* upper = corner + strideZ;
  const float c001 = upper[0], c101 = upper[1], c011 = upper[strideY], c111 = upper[strideY + 1];
  const float x00 = c000 + t.x * (c100 - c000), x10 = c010 + t.x * (c110 - c010);
  const float x01 = c001 + t.x * (c101 - c001), x11 = c011 + t.x * (c111 - c011);
  const float y0 = x00 + t.y * (x10 - x00), y1 = x01 + t.y * (x11 - x01);
  const float gx = (1 - t.y) * (1 - t.z) * (c100 - c000) + t.y * (1 - t.z) * (c110 - c010) +
                   (1 - t.y) * t.z * (c101 - c001) + t.y * t.z * (c111 - c011);
  const float gy = (1 - t.z) * (x10 - x00) + t.z * (x11 - x01);
  return {y0 + t.z * (y1 - y0), {gx, gy, y1 - y0}};
}

/// Into [0, most]; NaN becomes 0, so that it leads to some cell.
WEIR_HD inline float clampTo(float x, float max) {
  return x > 0 ? (x < max ? x : max) : 0;
}

/// The cell of a coordinate in [0, count], and where in it.
WEIR_HD inline int cellAt(float x, int count, float& t) {
  int cell = static_cast<int>(x);
  cell = cell >= count ? count - 1 : cell;
  t = x - static_cast<float>(cell);
  return cell;
}

}  // namespace detail

WEIR_HD inline SignedDistance MeshSdfView::query(const Vec3f& p) const {
  const Vec3f local = (p - origin) / cellSize;
  const Vec3f inside{detail::clampTo(local.x, static_cast<float>(bricks.x * kBrick)),
                     detail::clampTo(local.y, static_cast<float>(bricks.y * kBrick)),
                     detail::clampTo(local.z, static_cast<float>(bricks.z * kBrick))};
  Vec3f t;
  const int bx = detail::cellAt(inside.x / kBrick, bricks.x, t.x);
  const int by = detail::cellAt(inside.y / kBrick, bricks.y, t.y);
  const int bz = detail::cellAt(inside.z / kBrick, bricks.z, t.z);
  const int brick = brickIndex[(bz * bricks.y + by) * bricks.x + bx];

  detail::Interpolated found;
  if (brick < 0) {
    const int strideY = bricks.x + 1, strideZ = strideY * (bricks.y + 1);
    found = detail::trilinear(coarse + bz * strideZ + by * strideY + bx, strideY, strideZ, t);
  } else {
    Vec3f u;
    const int cx = detail::cellAt(t.x * kBrick, kBrick, u.x);
    const int cy = detail::cellAt(t.y * kBrick, kBrick, u.y);
    const int cz = detail::cellAt(t.z * kBrick, kBrick, u.z);
    const float* corner = nodes + static_cast<std::int64_t>(brick) * (kNodes * kNodes * kNodes) +
                          (cz * kNodes + cy) * kNodes + cx;
    found = detail::trilinear(corner, kNodes, kNodes * kNodes, u);
  }
  const float slope = length(found.gradient);
  SignedDistance result{found.value, slope > 0 ? found.gradient / slope : Vec3f{0, 1, 0},
                        slope / (brick < 0 ? kBrick * cellSize : cellSize)};
  const Vec3f beyond = (local - inside) * cellSize;
  const float away = length(beyond);
  if (away > 0) {
    // The nearest point of the surface is about where the gradient at the edge of the grid leads.
    const Vec3f fromSurface = result.normal * result.distance + beyond;
    result = {length(fromSurface), normalized(fromSurface)};
  }
  return inverted ? SignedDistance{-result.distance, -result.normal, result.slope} : result;
}

}  // namespace weir
