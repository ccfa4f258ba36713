#include "nodes/particle_fluid/inflow.h"
#include "framework/compute/parallel.h"

namespace weir {

namespace {

/// Particles of other batches have other numbers.
struct Carry {
  std::int64_t firstId;
  float age;          // s
  float maxDistance;  // m, from where it should be
  ArrayView<const Vec3f> from, velocity;
  ArrayView<const std::int64_t> ids;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    const std::int64_t k = ids[i] - firstId;
    if (k < 0 || k >= from.size) return;
    const Vec3f place = from[k] + age * velocity[k];
    if (length(positions[i] - place) > maxDistance) return;
    positions[i] = place;
    velocities[i] = velocity[k];
  }
};

}  // namespace

template <class Backend>
void Inflow::carryOn(Backend& device, const Batch& batch, ParticleSet& particles, float age, float spacing) {
  constexpr float kLetGo = 0.1f;  // spacings
  parallelFor(device, "inflow", particles.count(),
              Carry{batch.firstId, age, kLetGo * spacing, batch.positions.view(), batch.velocities.view(),
                    particles.ids().read(), particles.positions().write(), particles.velocities().write()});
}

template void Inflow::carryOn(ThisBackend&, const Batch&, ParticleSet&, float, float);

}  // namespace weir
