#include "tests/framework/geometry/clearance_grid_kernel.h"

namespace weir::test {
namespace {

struct LookUp {
  ClearanceView clearance;
  ArrayView<const Vec3f> points;
  ArrayView<float> out;
  WEIR_HD void operator()(std::int64_t i) const { out[i] = clearance.at(points[i]); }
};

}  // namespace

template <class Backend>
void lookUpClearances(Backend& device, const ClearanceView& clearance, ArrayView<const Vec3f> points,
                      ArrayView<float> out) {
  parallelFor(device, "lookUpClearances", points.size, LookUp{clearance, points, out});
}

template void lookUpClearances(ThisBackend&, const ClearanceView&, ArrayView<const Vec3f>, ArrayView<float>);

}  // namespace weir::test
