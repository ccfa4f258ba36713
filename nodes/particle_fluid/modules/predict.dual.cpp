#include "nodes/particle_fluid/modules/predict.h"

namespace weir {

namespace {

struct PredictParticle {
  Vec3f gravity;
  float dt;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f v = velocities[i] + dt * gravity;
    velocities[i] = v;
    positions[i] += dt * v;
  }
};

}  // namespace

template <class Backend>
void Predict::stepOn(Backend& device, FluidStep& fluid) {
  parallelFor(device, "predict", fluid.particles.count(),
              PredictParticle{fluid.time.gravity, static_cast<float>(fluid.time.dt),
                              fluid.particles.positions().view(), fluid.particles.velocities().view()});
}

template void Predict::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
