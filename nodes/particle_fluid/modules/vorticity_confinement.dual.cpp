#include "nodes/particle_fluid/modules/vorticity_confinement.h"

namespace weir {

namespace {

/// Weight |W'|/r of a pair, and what it adds to 3·N. A pair in one place has no direction and no weight.
WEIR_HD float pairWeight(const SpikyKernel& kernel, const Vec3f& d, float& norm) {
  const float r = sqrtf(dot(d, d));
  if (r == 0) return 0;
  const float slope = kernel.slope(r);
  norm += slope * r;
  return slope / r;
}

WEIR_HD Vec3f perNorm(const Vec3f& sum, float norm) {
  return norm > 0 ? (3 / norm) * sum : Vec3f{};
}

struct Vorticity {
  NeighborView neighbors;
  SpikyKernel kernel;
  ArrayView<const Vec3f> positions, velocities;
  ArrayView<Vec3f> vorticity;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i], v = velocities[i];
    Vec3f sum{};
    float norm = 0;
    forEachNeighbor(i, neighbors, [&](int j) {
      const Vec3f d = positions[j] - p;
      sum += pairWeight(kernel, d, norm) * cross(d, velocities[j] - v);
    });
    vorticity[i] = perNorm(sum, norm);
  }
};

struct Confine {
  NeighborView neighbors;
  SpikyKernel kernel;
  float impulse;   // dt·strength·d, m
  float minSlope;  // of |ω|, over |ω|: 0.01/d
  ArrayView<const Vec3f> positions, vorticity;
  ArrayView<Vec3f> velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i], own = vorticity[i];
    const float magnitude = length(own);
    if (magnitude == 0) return;
    Vec3f sum{};
    float norm = 0;
    forEachNeighbor(i, neighbors, [&](int j) {
      const Vec3f d = positions[j] - p;
      sum += (pairWeight(kernel, d, norm) * (length(vorticity[j]) - magnitude)) * d;
    });
    const Vec3f slope = perNorm(sum, norm);
    velocities[i] += (impulse / (length(slope) + minSlope * magnitude)) * cross(slope, own);
  }
};

}  // namespace

template <class Backend>
void VorticityConfinement::stepOn(Backend& device, FluidStep& fluid) {
  constexpr float kMinSlope = 0.01f;  // per spacing
  const Count count = fluid.particles.count();
  const FluidConstants& c = fluid.constants;
  fluid.exchange({"position", "velocity"});
  const auto positions = fluid.particles.positions().read();
  parallelFor(device, "vorticity", count,
              Vorticity{fluid.neighbors.view(), c.kernel, positions, fluid.particles.velocities().read(),
                        vorticity_.write()});
  fluid.exchange({vorticity_.info().name});
  if (strength > 0)
    parallelFor(
        device, "confine", count,
        Confine{fluid.neighbors.view(), c.kernel, static_cast<float>(fluid.time.dt) * strength * c.spacing,
                kMinSlope / c.spacing, positions, vorticity_.read(), fluid.particles.velocities().write()});
}

template void VorticityConfinement::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
