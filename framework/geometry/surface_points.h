// Points spread evenly over the surface of a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "framework/base/api.h"
#include "framework/geometry/triangle_mesh.h"

namespace WEIR_API weir {

struct SurfacePoints {
  std::vector<Vec3f> positions;  ///< m
  std::vector<Vec3f> normals;    ///< of the triangles that they lie on, of length 1
};

/// `count` points with about the same area for each and no order among them (blue noise): the greedy sample
/// elimination of Yuksel (2015, "Sample Elimination for Generating Poisson Disk Sample Sets"). More than
/// that many are drawn, stratified by area; then the one that is most crowded goes, until `count` are left.
/// On a flat surface no two are closer than 0.65·√(area/count) or so, where a hexagonal lattice has
/// 1.07·√(area/count). The seed alone decides the result. Needs a mesh with area and finite vertices, and
/// takes O(count·log count).
SurfacePoints spreadOverSurface(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed);

}  // namespace weir
