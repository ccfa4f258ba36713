// Which way each face, edge and corner of a mesh points, to tell on which side of it a point is.
#pragma once

#include <vector>

#include "framework/base/api.h"
#include "framework/geometry/triangle_mesh.h"

namespace WEIR_API weir {

/// Angle-weighted pseudo-normals (Baerentzen and Aanaes 2005) of one triangle, unit vectors: if x is the
/// nearest point of a closed mesh to p, then p is outside exactly if (p − x)·n > 0 for the normal n of the
/// face, edge or corner that x lies on.
struct PseudoNormals {
  static constexpr int kFace = 0, kEdges = 1, kCorners = 4;
  /// The face's normal, then those of the edges from each corner to the next, then those of the corners. Zero
  /// where a triangle without area has no neighbour with one.
  Vec3f normals[7];
};

/// An edge's normal is the sum of its triangles' unit normals, a corner's n = Σ angle·normal, unless they
/// cancel; then the triangle's own normal is taken. Vertices at the same place count as one.
std::vector<PseudoNormals> pseudoNormals(const TriangleMesh& mesh);

}  // namespace weir
