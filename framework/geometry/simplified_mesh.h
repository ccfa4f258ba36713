// Fewer triangles for the same surface, up to a deviation that is known.
//
// Finely tessellated walls cost time without changing what fluid feels: the integrals over solids are sums
// over triangles, and a particle at a fine tessellation has hundreds of them within reach.
//
// A vertex u is merged into a neighbour v: the fan of triangles around u gives way to a fan from v over the
// same ring of vertices. This is done only where, seen along the ring's vector area n, both fans cover the
// same polygon once. Then each is a height over that polygon, and both are linear between the vertices of
// their overlay: u, and where the spokes of one cross those of the other. So the greatest difference of
// heights there bounds how far apart the two fans are, everywhere and in both directions. Every triangle
// carries the greatest sum of these bounds on its way from the original surface, and that never exceeds the
// tolerance.
//
// Merging keeps the topology: closed meshes stay closed, borders of sheets stay where they are, and nothing
// is torn, glued or turned round. Parts that are nearer to each other than twice the tolerance may come to
// overlap by that much.
#pragma once

#include "framework/base/api.h"
#include "framework/geometry/triangle_mesh.h"

namespace WEIR_API weir {

struct SimplifiedMesh {
  TriangleMesh mesh;     ///< its vertices are among those of the original
  double deviation = 0;  ///< m: no point of either surface is farther from the other
};

/// At most `tolerance` (m, not negative) off. With 0, or where nothing can be merged, the original. Vertices
/// on borders, or whose triangles are not a simple fan (three at an edge, turned differently, without area),
/// stay. The indices must be valid and the vertices finite. Takes O(n) or so; deterministic.
SimplifiedMesh simplified(const TriangleMesh& mesh, double tolerance);

}  // namespace weir
