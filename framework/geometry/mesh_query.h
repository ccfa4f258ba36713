// Distance to a triangle mesh, and whether a point is inside it, through a tree of boxes.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "framework/base/api.h"
#include "framework/geometry/box_tree.h"
#include "framework/geometry/triangle_mesh.h"

namespace WEIR_API weir {

/// Keeps its own copy of the triangles. Queries may run on many threads at once.
class MeshQuery {
 public:
  /// Takes O(n log n). Vertices must be finite; triangles without area are allowed.
  explicit MeshQuery(const TriangleMesh& mesh);

  /// The distance from p to the nearest point of the mesh in m, or `atMost` if that is smaller, which is
  /// found faster the smaller it is. Infinity for a mesh without triangles.
  float closestDistance(const Vec3f& p, float atMost = std::numeric_limits<float>::infinity()) const;

  /// The generalised winding number (Jacobson, Kavan, Sorkine-Hornung 2013): the signed solid angle under
  /// which the mesh is seen from p, over 4π. For a closed mesh 1 inside, 0 outside; around holes it passes
  /// smoothly from one to the other.
  ///
  /// Groups of triangles further away than kDipoleReach times their radius count as one dipole, at their
  /// centre of area (Barill et al. 2018), so expect errors of a few hundredths.
  double windingNumber(const Vec3f& p) const;

  static constexpr float kDipoleReach = 2;

 private:
  using Triangle = std::array<Vec3f, 3>;
  /// What the triangles below a tree node look like from afar.
  struct Dipole {
    Vec3f center;      ///< of area
    Vec3f areaNormal;  ///< sum of the normals times the areas
    float radius = 0;  ///< no vertex is further from the centre
  };

  Dipole dipoleOf(const BoxTree::Node& node) const;

  std::vector<Triangle> triangles_;  // in the order of the leaves
  std::vector<BoxTree::Node> tree_;
  std::vector<Dipole> dipoles_;  // of each tree node
};

}  // namespace weir
