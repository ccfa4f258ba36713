#include "nodes/particle_fluid/modules/solid_contact.h"

#include <algorithm>

#include "framework/compute/parallel_uneven.h"
#include "nodes/particle_fluid/solid_collision.h"

namespace weir {

namespace {

/// Particles that may have been pushed into a solid, or that a solid may rub.
struct MayTouch {
  ArrayView<const SolidView> solids;
  SolidGridView grid;
  float gap;
  ArrayView<const Vec3f> legal, positions;
  ArrayView<const float> d;  // empty where no solid rubs

  WEIR_HD bool operator()(std::int64_t i) const {
    return (d.size > 0 && d[i] > 0) || !isClearOfSolids(solids, grid, true, gap, legal[i], positions[i]);
  }
};

struct Contact {
  ArrayView<const SolidView> solids;
  SolidGridView grid;
  float gap, dt;
  float contactPhi;  // Φ of what touches a plane
  SolidPairsView pairs;
  ArrayView<const int> met;
  ArrayView<const Vec3f> legal;
  ArrayView<const Vec4f> each;
  ArrayView<const float> share;
  ArrayView<Vec3f> positions, velocities;
  ArrayView<Vec4f> kick;

  WEIR_HD void operator()(std::int64_t m) const {
    const int i = met[m];
    const Vec3f v = velocities[i];
    StoppedParticle after = stopAtSolids(solids, grid, true, gap, legal[i], positions[i], v);
    if (after.solid >= 0) positions[i] = after.position;
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) rub(i, pair, after);
    const Vec3f change = after.velocity - v;
    kick[m] = {change.x, change.y, change.z, static_cast<float>(after.solid)};
    if (after.solid >= 0) velocities[i] = after.velocity;
  }

  WEIR_HD void rub(int i, int pair, StoppedParticle& particle) const {
    const int k = pairs.solid[pair];
    const SolidView& solid = solids[k];
    const Vec4f at = each[pair];
    const Vec3f gradient = xyz(at);
    const float steep = length(gradient);
    if (!(steep > 0) || (solid.friction == 0 && solid.noSlip == 0)) return;
    const Vec3f normal = gradient / -steep;
    const Vec3f wall = solid.velocityAt(particle.position);
    const Vec3f relative = particle.velocity - wall;
    const float approach = dot(relative, normal);
    const Vec3f along = relative - approach * normal;
    const float slip = length(along);
    if (!(slip > 0)) return;
    const float max = solid.friction * fabsf(share[i]) * steep / dt;
    const float touch = at.w < contactPhi ? at.w / contactPhi : 1.0f;
    const float kept = slip > max ? (1 - max / slip) * expf(-solid.noSlip * dt * touch) : 0.0f;
    particle.velocity = wall + approach * normal + kept * along;
    particle.solid = k;
  }
};

/// What solids feel of the pressure of particle near[n].
struct PressureImpulse {
  ArrayView<const SolidView> solids;
  float massPerDt;  // kg/s
  SolidPairsView pairs;
  ArrayView<const int> near;
  ArrayView<const Vec3f> positions;
  ArrayView<const Vec4f> each;
  ArrayView<const float> share;
  ArrayView<const Vec3f> remainder;  // see WallField

  template <class Give>
  WEIR_HD void operator()(std::int64_t n, const Give& give) const {
    const int i = near[n];
    const float s = share[i];
    const Vec3f rest = remainder.size > 0 ? remainder[i] : Vec3f{};
    if (s == 0 && rest == Vec3f{}) return;
    // The remainder is each solid's by how much its ∇Φ is of all.
    float all = 0;
    if (!(rest == Vec3f{}))
      for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) all += length(xyz(each[pair]));
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) {
      const int k = pairs.solid[pair];
      const Vec3f gradient = xyz(each[pair]);
      const float part = all > 0 ? length(gradient) / all : 0.0f;
      give(k, [&] {
        return impulseAt(-massPerDt * (s * gradient + part * rest), positions[i] - solids[k].pivot);
      });
    }
  }
};

}  // namespace

template <class Backend>
void SolidContact::stepOn(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  const ArrayView<const SolidView> solids = walls.views.view();
  const SolidGridView grid = walls.grid.view();
  const SolidPairsView pairs = walls.pairs.view();
  const ArrayView<Vec3f> positions = fluid.particles.positions().write();
  const ArrayView<const Vec3f> legal = std::as_const(walls.legal).view();
  const ArrayView<const Vec4f> each = std::as_const(walls.each).view();
  const float gap = kSolidGap * fluid.constants.spacing, dt = static_cast<float>(fluid.time.dt);
  const bool rubs = std::any_of(walls.solids.begin(), walls.solids.end(), [](const Solid* solid) {
    return solid->surface().friction > 0 || solid->surface().noSlip > 0;
  });
  walls.list(device, "may touch", fluid.particles.count(),
             MayTouch{solids, grid, gap, legal, positions,
                      rubs ? std::as_const(walls.d).view() : ArrayView<const float>{}},
             walls.met, walls.metCounter);
  parallelForUneven(device, "contact", walls.metCount(),
                    Contact{solids, grid, gap, dt, 0.5f * fluid.constants.wallFactor, pairs,
                            std::as_const(walls.met).view(), legal, each, walls.share.read(), positions,
                            fluid.particles.velocities().write(), walls.kick.view()});
  walls.listHits(device);
  shareKicks(device, fluid);
  sumContacts(device, fluid);
  sumByKeyOverRanks(device, "pressure impulse",
                    {ranksOf(fluid), walls.pairs.nearCount(), walls.pairs.bySolid()}, solids.size,
                    PressureImpulse{solids, fluid.constants.particleMass / dt, pairs, walls.pairs.near(),
                                    positions, each, walls.share.read(), walls.remainder},
                    AddImpulses{}, walls.impulses.data() + solids.size);
  giveImpulses(device, walls, 2);
}

template void SolidContact::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
