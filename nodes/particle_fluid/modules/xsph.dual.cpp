#include "nodes/particle_fluid/modules/xsph.h"

namespace weir {

namespace {

struct SmoothVelocity {
  NeighborView neighbors;
  SpikyKernel kernel;
  float weight;  // c·V0
  ArrayView<const Vec3f> positions, velocities;
  ArrayView<Vec3f> smoothed;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i], v = velocities[i];
    Vec3f sum{};
    forEachNeighbor(i, neighbors, [&](int j) {
      const Vec3f d = positions[j] - p;
      sum += kernel.value(sqrtf(dot(d, d))) * (velocities[j] - v);
    });
    smoothed[i] = v + weight * sum;
  }
};

}  // namespace

template <class Backend>
void Xsph::stepOn(Backend& device, FluidStep& fluid) {
  if (smoothed_.data() == nullptr) smoothed_ = Array<Vec3f>(fluid.device);
  smoothed_.resize(fluid.particles.velocities().size());
  const FluidConstants& c = fluid.constants;
  parallelFor(device, "smooth", fluid.particles.count(),
              SmoothVelocity{fluid.neighbors.view(), c.kernel, strength * c.particleVolume,
                             fluid.particles.positions().view(), fluid.particles.velocities().view(),
                             smoothed_.view()});
  // Equal sizes; only the memory changes hands.
  smoothed_.swap(fluid.particles.velocities());
}

template void Xsph::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
