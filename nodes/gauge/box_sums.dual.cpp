#include "nodes/gauge/box_sums.h"

#include "framework/compute/parallel.h"

namespace weir {

namespace {

struct SumsOfOne {
  MatterView matter;
  Aabb box;

  WEIR_HD BoxSums operator()(std::int64_t i) const {
    const ParticleMatter p = matter[i];
    if (!box.contains(p.position)) return {};
    const double volume = p.volume, mass = volume * double(p.restDensity);
    const Vec3d v{p.velocity.x, p.velocity.y, p.velocity.z};
    return {.particles = 1,
            .volume = volume,
            .mass = mass,
            .momentum = mass * v,
            .kineticEnergy = 0.5 * mass * dot(v, v),
            .density = volume * double(p.density),
            .pressure = volume * double(p.pressure)};
  }
};

struct AddSums {
  WEIR_HD BoxSums operator()(const BoxSums& a, const BoxSums& b) const {
    return {.particles = a.particles + b.particles,
            .volume = a.volume + b.volume,
            .mass = a.mass + b.mass,
            .momentum = a.momentum + b.momentum,
            .kineticEnergy = a.kineticEnergy + b.kineticEnergy,
            .density = a.density + b.density,
            .pressure = a.pressure + b.pressure};
  }
};

}  // namespace

template <class Backend>
void sumBox(Backend& device, const Particles& particles, const Aabb& box, BoxSums* sums) {
  reduce(device, "sum box", particles.set().count(), BoxSums{}, SumsOfOne{matterOf(particles), box},
         AddSums{}, sums);
}

template void sumBox(ThisBackend&, const Particles&, const Aabb&, BoxSums*);

}  // namespace weir
