#include "nodes/particle_fluid/modules/surface_tension.h"

#include "nodes/particle_fluid/poly6_kernel.h"
#include "nodes/particle_fluid/scratch.h"

namespace weir {

namespace {

struct ColorField {
  NeighborView neighbors;
  Poly6Kernel kernel;
  float particleVolume;
  ArrayView<const Vec3f> positions;
  ArrayView<float> color;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    float sum = kernel.value0;
    forEachNeighbor(i, neighbors, [&](int j) { sum += kernel.value(p - positions[j]); });
    color[i] = particleVolume * sum;
  }
};

/// Half of what a pair of two like particles is drawn together with, Pa.
struct SurfaceStress {
  NeighborView neighbors;
  Poly6Kernel kernel;
  float particleVolume, coefficient, airPressure;
  ArrayView<const Vec3f> positions;
  ArrayView<const float> color;
  ArrayView<float> stress;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    Vec3f sum{};
    forEachNeighbor(i, neighbors, [&](int j) { sum += color[j] * kernel.gradient(p - positions[j]); });
    const Vec3f gradient = (particleVolume / color[i]) * sum;
    stress[i] = 0.25f * coefficient * dot(gradient, gradient) + 0.5f * airPressure;
  }
};

struct Contract {
  NeighborView neighbors;
  Poly6Kernel kernel;
  float factor;  // dt·V0/ρ0
  ArrayView<const Vec3f> positions;
  ArrayView<const float> stress;
  ArrayView<Vec3f> velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    const float own = stress[i];
    Vec3f sum{};
    forEachNeighbor(i, neighbors,
                    [&](int j) { sum += (own + stress[j]) * kernel.gradient(p - positions[j]); });
    velocities[i] += factor * sum;
  }
};

}  // namespace

template <class Backend>
void SurfaceTension::stepOn(Backend& device, FluidStep& fluid) {
  fitScratch(fluid, color_, stress_);
  fluid.exchange({"position"});
  const Count count = fluid.particles.count();
  const FluidConstants& c = fluid.constants;
  const NeighborView neighbors = fluid.neighbors.view();
  const Poly6Kernel kernel(c.supportRadius);
  const auto positions = fluid.particles.positions().read();
  const float factor = static_cast<float>(fluid.time.dt) * c.particleVolume / c.restDensity;
  parallelFor(device, "color", count,
              ColorField{neighbors, kernel, c.particleVolume, positions, color_.view()});
  fluid.exchange(color_.view());
  parallelFor(device, "surface stress", count,
              SurfaceStress{neighbors, kernel, c.particleVolume, coefficient, airPressure, positions,
                            color_.view(), stress_.view()});
  fluid.exchange(stress_.view());
  parallelFor(
      device, "contract", count,
      Contract{neighbors, kernel, factor, positions, stress_.view(), fluid.particles.velocities().write()});
}

template void SurfaceTension::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
