// Asks a tree of triangles on a device.
#pragma once

#include <bit>

#include "framework/compute/parallel.h"
#include "framework/geometry/triangle_tree.h"

namespace weir::test {

/// What a ball of the radius around a point met, as sums that no order changes.
struct NearTriangles {
  int count = 0;
  std::uint32_t hash = 0;  ///< sum of hashOf the triangles
};

/// Depends on the bits of the corners and on their order.
WEIR_HD inline std::uint32_t hashOf(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  std::uint32_t hash = 2166136261u;
  for (const Vec3f& v : {a, b, c})
    for (int k = 0; k < 3; ++k) hash = (hash ^ std::bit_cast<std::uint32_t>(v[k])) * 16777619u;
  return hash;
}

/// out[i] = the triangles that the tree reports near points[i]
template <class Backend>
void gatherNear(Backend& device, const TriangleTreeView& tree, float radius, ArrayView<const Vec3f> points,
                ArrayView<NearTriangles> out);

/// out[i] = tree.nearest(points[i], atMost)
template <class Backend>
void findNearest(Backend& device, const TriangleTreeView& tree, float atMost, ArrayView<const Vec3f> points,
                 ArrayView<SurfacePoint> out);

}  // namespace weir::test
