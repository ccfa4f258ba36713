#include "tests/framework/geometry/triangle_tree_kernel.h"

namespace weir::test {
namespace {

struct GatherNear {
  TriangleTreeView tree;
  float radius;
  ArrayView<const Vec3f> points;
  ArrayView<NearTriangles> out;
  WEIR_HD void operator()(std::int64_t i) const {
    NearTriangles found;
    tree.forEachTriangleNear(points[i], radius, [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) {
      ++found.count;
      found.hash += hashOf(a, b, c);
    });
    out[i] = found;
  }
};

struct FindNearest {
  TriangleTreeView tree;
  float atMost;
  ArrayView<const Vec3f> points;
  ArrayView<SurfacePoint> out;
  WEIR_HD void operator()(std::int64_t i) const { out[i] = tree.nearest(points[i], atMost); }
};

}  // namespace

template <class Backend>
void gatherNear(Backend& device, const TriangleTreeView& tree, float radius, ArrayView<const Vec3f> points,
                ArrayView<NearTriangles> out) {
  parallelFor(device, "gatherNear", points.size, GatherNear{tree, radius, points, out});
}

template void gatherNear(ThisBackend&, const TriangleTreeView&, float, ArrayView<const Vec3f>,
                         ArrayView<NearTriangles>);

template <class Backend>
void findNearest(Backend& device, const TriangleTreeView& tree, float atMost, ArrayView<const Vec3f> points,
                 ArrayView<SurfacePoint> out) {
  parallelFor(device, "findNearest", points.size, FindNearest{tree, atMost, points, out});
}

template void findNearest(ThisBackend&, const TriangleTreeView&, float, ArrayView<const Vec3f>,
                          ArrayView<SurfacePoint>);

}  // namespace weir::test
