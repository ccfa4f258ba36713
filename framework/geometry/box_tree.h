// A tree of boxes around the triangles of a mesh, built once on the host; what MeshQuery and TriangleTree
// share.
#pragma once

#include <vector>

#include "framework/base/api.h"
#include "framework/geometry/triangle_mesh.h"

namespace WEIR_API weir {

struct BoxTree {
  static constexpr int kLeaf = 4;  ///< triangles in a leaf at most
  /// No leaf is deeper (the root has depth 0), and a traversal that keeps the other child of each node on the
  /// way for later never keeps more than that many: halving 2³¹ triangles ends at 31, and fewer than 24 times
  /// on the way large triangles are set apart.
  static constexpr int kDepth = 56;

  struct Node {
    Aabb box;
    int first = 0, last = 0;  ///< its triangles are [first, last) in `order`
    int child = 0;            ///< its first child, the second comes next; 0 in leaves
  };

  std::vector<Node> nodes;  ///< the root comes first, children after their parents; empty without triangles
  std::vector<int> order;   ///< indices of the mesh's triangles
};

/// Halves the triangles by the middles of their boxes along the longest axis, after setting apart those few
/// that are far larger than the rest, so that a floor of two triangles does not blow up the boxes of an
/// ornament. Takes O(n log n). Vertices must be finite; triangles without area are allowed.
BoxTree buildBoxTree(const TriangleMesh& mesh);

}  // namespace weir
