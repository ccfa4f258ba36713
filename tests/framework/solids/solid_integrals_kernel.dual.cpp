#include "tests/framework/solids/solid_integrals_kernel.h"

namespace weir::test {
namespace {

struct Integrate {
  float supportRadius;
  ArrayView<const Vec3f> corners;
  ArrayView<const Vec3f> points;
  ArrayView<SolidIntegrals<float>> out;
  WEIR_HD void operator()(std::int64_t i) const {
    SolidIntegrator<float> solid(points[i], supportRadius);
    for (std::int64_t k = 0; k + 2 < corners.size; k += 3)
      solid.addTriangle(corners[k], corners[k + 1], corners[k + 2]);
    out[i] = solid.integrals(1);
  }
};

}  // namespace

template <class Backend>
void integrateAll(Backend& device, float supportRadius, ArrayView<const Vec3f> corners,
                  ArrayView<const Vec3f> points, ArrayView<SolidIntegrals<float>> out) {
  parallelFor(device, "integrateAll", points.size, Integrate{supportRadius, corners, points, out});
}

template void integrateAll(ThisBackend&, float, ArrayView<const Vec3f>, ArrayView<const Vec3f>,
                           ArrayView<SolidIntegrals<float>>);

}  // namespace weir::test
