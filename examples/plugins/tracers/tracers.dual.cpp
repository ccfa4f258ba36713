#include <cmath>

#include <weir/parallel.h>

#include "tracers.h"

namespace tracers {

namespace {

constexpr float kTwoPi = 6.28318530717959f;

struct Turn {
  Vec3f center, axis;  // of length 1
  float strength;      // circulation/2π, m²/s
  float core, dt;
  ArrayView<Vec3f> positions, velocities;
  ArrayView<float> revolutions;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f d = positions[i] - center;
    const Vec3f from = d - dot(d, axis) * axis;
    const float q = dot(from, from) / (core * core);
    // (1 − exp(−q))/q; its series near the axis, where the difference would cancel
    const float profile = q > 1e-3f ? (1 - expf(-q)) / q : 1 - 0.5f * q;
    const float rate = strength * profile / (core * core), angle = rate * dt;
    const Vec3f to = cosf(angle) * from + sinf(angle) * cross(axis, from);
    positions[i] += to - from;
    velocities[i] = rate * cross(axis, to);
    revolutions[i] += angle / kTwoPi;
  }
};

}  // namespace

template <class Backend>
void VortexTracers::driftOn(Backend& device, float dt) {
  ParticleSet& set = **set_;
  parallelFor(device, "drift", set.count(),
              Turn{center, axis.get() / length(axis.get()), circulation / kTwoPi, core, dt,
                   set.positions().write(), set.velocities().write(), revolutions_.write()});
}

template void VortexTracers::driftOn(ThisBackend&, float);

}  // namespace tracers
