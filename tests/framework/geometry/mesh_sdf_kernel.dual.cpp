#include "tests/framework/geometry/mesh_sdf_kernel.h"

namespace weir::test {
namespace {

struct Query {
  MeshSdfView sdf;
  ArrayView<const Vec3f> points;
  ArrayView<SignedDistance> out;
  WEIR_HD void operator()(std::int64_t i) const { out[i] = sdf.query(points[i]); }
};

}  // namespace

template <class Backend>
void queryAll(Backend& device, const MeshSdfView& sdf, ArrayView<const Vec3f> points,
              ArrayView<SignedDistance> out) {
  parallelFor(device, "queryAll", points.size, Query{sdf, points, out});
}

template void queryAll(ThisBackend&, const MeshSdfView&, ArrayView<const Vec3f>, ArrayView<SignedDistance>);

}  // namespace weir::test
