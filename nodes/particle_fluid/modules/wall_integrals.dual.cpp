#include "nodes/particle_fluid/modules/wall_integrals.h"

#include "nodes/solids/solid_integrals.h"

namespace weir {

namespace {

/// In the frame of the world.
WEIR_HD SolidIntegrals<float> integralsOf(const SolidView& solid, const Vec3f& position, float radius,
                                          float calibration) {
  const Vec3f p = solid.end.toBody(position);
  SolidIntegrator<float> sum(p, radius);
  const bool container = solid.kind == SolidKind::kContainer;
  solid.tree.forEachTriangleNear(p, radius, [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const Vec3f &second = container ? c : b, &third = container ? b : c;
    if (solid.approximate)
      sum.addTriangleApproximately(a, second, third);
    else
      sum.addTriangle(a, second, third);
  });
  SolidIntegrals<float> found =
      solid.kind == SolidKind::kSheet ? sum.integralsOfSheet(calibration) : sum.integrals(calibration);
  found.gradPhi = solid.end.directionToWorld(found.gradPhi);
  return found;
}

struct FindIntegrals {
  ArrayView<const SolidView> solids;
  float radius, calibration;
  std::int64_t stride;
  ArrayView<const Vec3f> positions;
  ArrayView<Vec4f> each, total;  // total is empty where there is one solid
  ArrayView<float> d;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    Vec3f gradient{};
    float phi = 0, sumOfD = 0;
    for (std::int64_t k = 0; k < solids.size; ++k) {
      const SolidIntegrals<float> of = integralsOf(solids[k], p, radius, calibration);
      each[k * stride + i] = {of.gradPhi.x, of.gradPhi.y, of.gradPhi.z, of.phi};
      gradient += of.gradPhi;
      phi += of.phi;
      sumOfD += of.d;
    }
    if (total.size > 0) total[i] = {gradient.x, gradient.y, gradient.z, phi};
    d[i] = sumOfD;
  }
};

}  // namespace

template <class Backend>
void WallIntegrals::findOn(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  walls.fit(fluid.particles);
  const bool several = walls.solids.size() > 1;
  walls.keepLegal(fluid.particles.positions());
  walls.base = {};
  parallelFor(device, "wall integrals", fluid.particles.count(),
              FindIntegrals{walls.views.view(), fluid.constants.wallRadius, fluid.constants.calibration,
                            walls.stride, fluid.particles.positions().view(), walls.each.view(),
                            several ? walls.total.view() : ArrayView<Vec4f>{}, walls.d.view()});
}

template void WallIntegrals::findOn(ThisBackend&, FluidStep&);

}  // namespace weir
