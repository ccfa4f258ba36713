#include "vortex_force.h"

namespace vortex_force {

namespace {

struct Swirl {
  Vec3f center, axis;  // of length 1
  float strength;      // growth/2π, m²/s²
  float core, dt;
  ArrayView<const Vec3f> positions;
  ArrayView<Vec3f> velocities, swirl;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f d = positions[i] - center;
    const Vec3f s = d - dot(d, axis) * axis;
    const float q = dot(s, s) / (core * core);
    // (1 − exp(−q))/q; its series near the axis, where the difference would cancel
    const float profile = q > 1e-3f ? (1 - expf(-q)) / q : 1 - 0.5f * q;
    const Vec3f a = (strength * profile / (core * core)) * cross(axis, s);
    velocities[i] += dt * a;
    swirl[i] = a;
  }
};

}  // namespace

template <class Backend>
void VortexForce::stepOn(Backend& device, FluidStep& fluid) {
  constexpr float kTwoPi = 6.28318530717959f;
  ParticleSet& particles = fluid.particles;
  parallelFor(
      device, "vortex", particles.count(),
      Swirl{center, axis.get() / length(axis.get()), growth / kTwoPi, core, static_cast<float>(fluid.time.dt),
            particles.positions().read(), particles.velocities().write(), swirl_.write()});
}

template void VortexForce::stepOn(ThisBackend&, FluidStep&);

}  // namespace vortex_force
