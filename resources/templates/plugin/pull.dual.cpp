// Compiled for each instruction set of the CPU and, where there is nvcc, for CUDA.
#include "pull.h"

namespace my_plugin {

namespace {

/// A kernel: plain numbers and views by value, and what is done for particle i.
struct PullParticle {
  Vec3f center;
  float rateSquared, dt;
  ArrayView<const Vec3f> positions;
  ArrayView<Vec3f> velocities;
  ArrayView<float> pull;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f a = rateSquared * (center - positions[i]);
    velocities[i] += dt * a;
    pull[i] = length(a);
  }
};

}  // namespace

template <class Backend>
void Pull::stepOn(Backend& device, FluidStep& fluid) {
  ParticleSet& particles = fluid.particles;
  parallelFor(device, "pull", particles.count(),
              PullParticle{center, rate * rate, static_cast<float>(fluid.time.dt),
                           particles.positions().read(), particles.velocities().write(), pull_.write()});
}

template void Pull::stepOn(ThisBackend&, FluidStep&);

}  // namespace my_plugin
