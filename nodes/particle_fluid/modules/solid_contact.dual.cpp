#include "nodes/particle_fluid/modules/solid_contact.h"

#include "nodes/particle_fluid/solid_collision.h"

namespace weir {

namespace {

struct Contact {
  ArrayView<const SolidView> solids;
  float gap, dt;
  float contactPhi;  // Φ of what touches a plane
  std::int64_t stride;
  ArrayView<const Vec3f> legal;
  ArrayView<const Vec4f> each;
  ArrayView<const float> share;
  ArrayView<Vec3f> positions, velocities;
  ArrayView<Vec4f> kick;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f v = velocities[i];
    StoppedParticle after = stopAtSolids(solids, true, gap, legal[i], positions[i], v);
    if (after.solid >= 0) positions[i] = after.position;
    for (std::int64_t k = 0; k < solids.size; ++k) rub(i, k, after);
    const Vec3f change = after.velocity - v;
    kick[i] = {change.x, change.y, change.z, static_cast<float>(after.solid)};
    if (after.solid >= 0) velocities[i] = after.velocity;
  }

  WEIR_HD void rub(std::int64_t i, std::int64_t k, StoppedParticle& particle) const {
    const SolidView& solid = solids[k];
    const Vec4f at = each[k * stride + i];
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
    const float most = solid.friction * fabsf(share[i]) * steep / dt;
    const float touch = at.w < contactPhi ? at.w / contactPhi : 1.0f;
    const float kept = slip > most ? (1 - most / slip) * expf(-solid.noSlip * dt * touch) : 0.0f;
    particle.velocity = wall + approach * normal + kept * along;
    particle.solid = static_cast<int>(k);
  }
};

/// What solid k feels of particle i by contact and by pressure.
struct TotalImpulse {
  ContactImpulse contact;
  float massPerDt;  // kg/s
  std::int64_t first;
  ArrayView<const Vec4f> each;
  ArrayView<const float> share;

  WEIR_HD SolidImpulse operator()(std::int64_t i) const {
    SolidImpulse sum = contact(i);
    const float s = share[i];
    if (s != 0) sum += impulseAt(-massPerDt * s * xyz(each[first + i]), contact.positions[i] - contact.pivot);
    return sum;
  }
};

}  // namespace

template <class Backend>
void SolidContact::stepOn(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  const ArrayView<Vec3f> positions = fluid.particles.positions().view();
  const float dt = static_cast<float>(fluid.time.dt), mass = fluid.constants.particleMass;
  parallelFor(
      device, "contact", fluid.particles.count(),
      Contact{walls.views.view(), kSolidGap * fluid.constants.spacing, dt, 0.5f * fluid.constants.calibration,
              walls.stride, walls.legal.view(), walls.each.view(), walls.share->view(), positions,
              fluid.particles.velocities().view(), walls.kick.view()});
  for (std::size_t k = 0; k < walls.solids.size(); ++k) {
    const ContactImpulse contact{static_cast<int>(k),
                                 walls.solids[k]->pivotAt(fluid.time.time + fluid.time.dt), mass, positions,
                                 walls.kick.view()};
    const TotalImpulse total{contact, mass / dt, static_cast<std::int64_t>(k) * walls.stride,
                             walls.each.view(), walls.share->view()};
    reduce(device, "impulse", fluid.particles.count(), SolidImpulse{}, total, AddImpulses{},
           walls.impulse.data());
    parallelFor(device, "add impulse", 1,
                AddImpulse{walls.solids[k]->impulse().data(), walls.impulse.data()});
  }
}

template void SolidContact::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
