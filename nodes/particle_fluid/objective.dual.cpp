#include "nodes/particle_fluid/objective.h"

#include "nodes/particle_fluid/displacement.h"
#include "nodes/particle_fluid/fluid_sums.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

namespace {

/// One particle's share of ψ. In double throughout: late iterations change ψ by less than a float can tell.
struct ParticleObjective {
  NeighborView neighbors;
  SpikyKernel kernel;
  double particleVolume, inertia, stiffness;  // m³, m/(2·dt²), K·V0
  BulkEnergy energy;
  bool tension;
  ArrayView<const Vec4f> state;
  ArrayView<const Vec3f> displacement;
  WallFieldView walls;

  WEIR_HD double operator()(std::int64_t i) const {
    const Vec3f p = xyz(state[i]);
    double sum = kernel.value0;
    forEachNeighbor(i, neighbors, [&](int j) {
      const Vec3f d = xyz(state[j]) - p;
      sum += kernel.value(sqrtf(dot(d, d)));
    });
    double over = particleVolume * sum - 1;
    if (!walls.empty()) over += walls.phi(i, p);
    const float excess = tension || over > 0 ? float(over) : 0.0f;
    const Vec3f u = displacement[i];
    const double ux = u.x, uy = u.y, uz = u.z;
    return inertia * (ux * ux + uy * uy + uz * uz) + stiffness * double(energy.value(excess));
  }
};

}  // namespace

template <class Backend>
void ObjectiveRecord::measureOn(Backend& device, FluidStep& fluid, const BulkEnergy& energy, bool tension,
                                ArrayView<const Vec4f> state, ArrayView<const Vec3f> displacement) {
  const FluidConstants& c = fluid.constants;
  const double dt = fluid.time.dt;
  const ParticleObjective objective{fluid.neighbors.view(),
                                    c.kernel,
                                    c.particleVolume,
                                    c.particleMass / (2 * dt * dt),
                                    double(c.bulkModulus) * c.particleVolume,
                                    energy,
                                    tension,
                                    state,
                                    displacement,
                                    fluid.walls.view()};
  const double ofSpacing = objective.inertia * double(c.spacing) * double(c.spacing);
  sumOverRanks(device, "objective", allOf(fluid), ofSpacing, objective, Plus{}, values_.data() + measured_);
}

template void ObjectiveRecord::measureOn(ThisBackend&, FluidStep&, const BulkEnergy&, bool,
                                         ArrayView<const Vec4f>, ArrayView<const Vec3f>);

}  // namespace weir
