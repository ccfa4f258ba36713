#include "nodes/gauge/gauge.h"

#include "framework/compute/parallel.h"
#include "framework/particles/rank_sums.h"
#include "nodes/gauge/particle_matter.h"

namespace weir {

namespace {

/// V·(v·n)·δ(s) of a particle.
struct FlowOfOne {
  MatterView matter;
  Vec3f center, normal;
  float radiusSquared, reach;

  WEIR_HD double operator()(std::int64_t i) const {
    const ParticleMatter p = matter[i];
    const Vec3f from = p.position - center;
    const float s = dot(from, normal), away = reach - fabsf(s);
    if (!(away > 0) || dot(from, from) - s * s > radiusSquared) return 0;
    return double(p.volume) * double(dot(p.velocity, normal)) * double(away) /
           (double(reach) * double(reach));
  }
};

struct AddPassed {
  double* flow;  // and the volume that has passed
  double dt;
  WEIR_HD void operator()(std::int64_t) const { flow[1] += dt * flow[0]; }
};

}  // namespace

template <class Backend>
void Gauge::flowOn(Backend& device, const Particles& of, Communicator* ranks, double dt) {
  constexpr float kReach = 2;  // spacings
  const float r = radius.get().value_or(INFINITY);
  const FlowOfOne flow{matterOf(of), position, (1 / length(normal.get())) * normal.get(), r * r,
                       kReach * of.material.spacing};
  sumOverRanks(device, "flow", {ranks, of.set().count()}, flow, Plus{}, flow_->data());
  parallelFor(device, "add flow", 1, AddPassed{flow_->data(), dt});
}

template void Gauge::flowOn(ThisBackend&, const Particles&, Communicator*, double);

}  // namespace weir
