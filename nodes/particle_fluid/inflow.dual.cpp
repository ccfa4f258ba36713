#include "nodes/particle_fluid/inflow.h"
#include "framework/compute/parallel.h"

namespace weir {

namespace {

/// Particles of other batches have other numbers.
struct Carry {
  std::int64_t firstId, together;
  float age;              // s, since the step in which they left began
  float letGo, interval;  // s: how old the first are then, and the next ones after them
  float dt;
  Vec3f gravity;
  float maxDistance;  // m, from where it should be
  ArrayView<const Vec3f> from, velocity;
  ArrayView<const std::int64_t> ids;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    const std::int64_t k = ids[i] - firstId;
    if (k < 0 || k >= from.size) return;
    const Vec3f place = from[k] + age * velocity[k];
    const float left = letGo + static_cast<float>(k / together) * interval - age;
    if (left <= 0 || length(positions[i] - place) > maxDistance) return;
    // The step adds dt·g, and moves by what that gives. Of it, `held` is too much.
    const float held = left < dt ? left : 0.0f;
    positions[i] = place - (0.5f * held * (dt - held)) * gravity;
    velocities[i] = velocity[k] - held * gravity;
  }
};

}  // namespace

template <class Backend>
void Inflow::carryOn(Backend& device, const Batch& batch, ParticleSet& particles, const StepContext& context,
                     float spacing) {
  constexpr double kLetGo = 0.1;  // spacings
  const FlowsIn::Flow& flow = batch.flow;
  const double interval = spacing / flow.speed;
  parallelFor(device, "inflow", particles.count(),
              Carry{.firstId = batch.firstId,
                    .together = flow.together,
                    .age = static_cast<float>(context.time - batch.born),
                    .letGo = static_cast<float>(flow.leaving + kCarried * interval),
                    .interval = static_cast<float>(interval),
                    .dt = static_cast<float>(context.dt),
                    .gravity = context.gravity,
                    .maxDistance = static_cast<float>(kLetGo * spacing),
                    .from = batch.positions.view(),
                    .velocity = batch.velocities.view(),
                    .ids = particles.ids().read(),
                    .positions = particles.positions().write(),
                    .velocities = particles.velocities().write()});
}

template void Inflow::carryOn(ThisBackend&, const Batch&, ParticleSet&, const StepContext&, float);

}  // namespace weir
