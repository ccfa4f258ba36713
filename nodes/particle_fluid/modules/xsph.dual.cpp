#include "nodes/particle_fluid/modules/xsph.h"

#include "nodes/particle_fluid/scratch.h"

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

/// One Jacobi sweep.
struct ApproachMean {
  NeighborView neighbors;
  SpikyKernel kernel;
  float share;  // b/(1 + b)
  ArrayView<const Vec3f> positions, initial, present;
  ArrayView<Vec3f> next;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i], v = initial[i];
    Vec3f sum{};
    float weights = 0;
    forEachNeighbor(i, neighbors, [&](int j) {
      const Vec3f d = positions[j] - p;
      const float w = kernel.value(sqrtf(dot(d, d)));
      sum += w * (present[j] - v);
      weights += w;
    });
    next[i] = weights > 0 ? v + (share / weights) * sum : v;
  }
};

}  // namespace

template <class Backend>
void Xsph::stepOn(Backend& device, FluidStep& fluid) {
  fitScratch(fluid, smoothed_);
  const FluidConstants& c = fluid.constants;
  parallelFor(device, "smooth", fluid.particles.count(),
              SmoothVelocity{fluid.neighbors.view(), c.kernel, strength * c.particleVolume,
                             fluid.particles.positions().view(), fluid.particles.velocities().view(),
                             smoothed_.view()});
  // Equal sizes; only the memory changes hands.
  smoothed_.swap(fluid.particles.velocities());
}

template <class Backend>
void Xsph::implicitOn(Backend& device, FluidStep& fluid) {
  constexpr int kSweeps = 3;
  fitScratch(fluid, smoothed_, next_);
  const FluidConstants& c = fluid.constants;
  const float b = static_cast<float>(fluid.time.dt) * viscosity / c.supportRadius;
  // Of infinite b, too.
  const float share = 1 / (1 + 1 / b);
  Array<Vec3f>& velocities = fluid.particles.velocities();
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const Array<Vec3f>& present = sweep == 0 ? velocities : smoothed_;
    parallelFor(device, "approach mean", fluid.particles.count(),
                ApproachMean{fluid.neighbors.view(), c.kernel, share, fluid.particles.positions().view(),
                             velocities.view(), present.view(), next_.view()});
    next_.swap(smoothed_);
  }
  smoothed_.swap(velocities);
}

template void Xsph::stepOn(ThisBackend&, FluidStep&);
template void Xsph::implicitOn(ThisBackend&, FluidStep&);

}  // namespace weir
