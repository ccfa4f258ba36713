// How particles are stopped at rigid meshes, and how that is told to the solids.
#pragma once

#include "framework/compute/parallel.h"
#include "framework/geometry/sweep.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

/// How near particles may come to a solid, in spacings. The pressure keeps the fluid at about half a spacing;
/// this is far below that, and far above the rounding of coordinates.
inline constexpr float kSolidGap = 0.1f;

/// The velocity after contact with a wall that moves at `wall`: no longer into it, and Coulomb's friction
/// takes at most μ times that change from the part along it. Without a normal the particle had no room to
/// move, and goes with the wall.
WEIR_HD inline Vec3f velocityAfterContact(const Vec3f& v, const Vec3f& wall, const Vec3f& normal,
                                          float friction) {
  if (!(dot(normal, normal) > 0)) return wall;
  const Vec3f relative = v - wall;
  const float approach = -dot(relative, normal);
  if (!(approach > 0)) return v;
  const Vec3f along = relative + approach * normal;
  const float slip = length(along);
  const float kept = slip > friction * approach ? 1 - friction * approach / slip : 0.0f;
  return wall + kept * along;
}

/// A particle on its way through all solids.
struct StoppedParticle {
  Vec3f position, velocity;
  int solid = -1;  ///< the last one that stopped it
};

/// Whether nothing of any solid can be near a particle's way; the same start and position as of stopAtSolids.
WEIR_HD inline bool isClearOfSolids(ArrayView<const SolidView> solids, bool atEnd, float gap,
                                    const Vec3f& start, const Vec3f& position) {
  for (std::int64_t k = 0; k < solids.size; ++k) {
    const SolidView& solid = solids[k];
    const Vec3f from = (atEnd ? solid.end : solid.begin).toBody(start);
    if (!isClear(solid.tree, solid.clearance, from, solid.end.toBody(position), gap)) return false;
  }
  return true;
}

/// From `start`, as it was when the solids were at their `begin` (or their `end`, if `atEnd`), to the
/// particle's position at their end.
WEIR_HD inline StoppedParticle stopAtSolids(ArrayView<const SolidView> solids, bool atEnd, float gap,
                                            const Vec3f& start, const Vec3f& position,
                                            const Vec3f& velocity) {
  // Leaving one solid may mean entering another.
  constexpr int kPasses = 4;
  StoppedParticle particle{position, velocity};
  for (int pass = 0; pass < kPasses; ++pass) {
    bool stopped = false;
    for (std::int64_t k = 0; k < solids.size; ++k) {
      const SolidView& solid = solids[k];
      const Vec3f from = (atEnd ? solid.end : solid.begin).toBody(start);
      const SweepResult way =
          sweep(solid.tree, solid.clearance, from, solid.end.toBody(particle.position), gap);
      if (!way.hit) continue;
      stopped = true;
      particle.position = solid.end.toWorld(way.position);
      particle.velocity = velocityAfterContact(particle.velocity, solid.velocityAt(particle.position),
                                               solid.end.directionToWorld(way.normal), solid.friction);
      particle.solid = static_cast<int>(k);
    }
    if (!stopped || solids.size == 1) return particle;
  }
  particle.position = start;  // between solids that leave no room
  return particle;
}

struct AddImpulses {
  WEIR_HD SolidImpulse operator()(SolidImpulse a, const SolidImpulse& b) const { return a += b; }
};

/// Adds some sums to another.
struct AddImpulse {
  SolidImpulse* to;
  const SolidImpulse* from;
  int sums;
  WEIR_HD void operator()(std::int64_t) const {
    for (int k = 0; k < sums; ++k) *to += from[k];
  }
};

WEIR_HD inline SolidImpulse impulseAt(const Vec3f& impulse, const Vec3f& arm) {
  const Vec3d j{impulse.x, impulse.y, impulse.z}, r{arm.x, arm.y, arm.z};
  return {j, cross(r, j)};
}

/// What solid k feels of the contact of particle met[i].
struct ContactImpulse {
  int solid;
  Vec3f pivot;
  float mass;
  ArrayView<const int> met;
  ArrayView<const Vec3f> positions;
  ArrayView<const Vec4f> kick;

  WEIR_HD SolidImpulse operator()(std::int64_t i) const {
    const Vec4f at = kick[i];
    if (static_cast<int>(at.w) != solid) return {};
    return impulseAt(-mass * xyz(at), positions[met[i]] - pivot);
  }
};

/// Sums what solid k feels of contact into walls.impulse[0].
template <class Backend>
ContactImpulse sumContact(Backend& device, FluidStep& fluid, std::size_t k) {
  WallField& walls = fluid.walls;
  const ContactImpulse contact{static_cast<int>(k),
                               walls.solids[k]->pivotAt(fluid.time.time + fluid.time.dt),
                               fluid.constants.particleMass,
                               std::as_const(walls.met).view(),
                               fluid.particles.positions().read(),
                               std::as_const(walls.kick).view()};
  reduce(device, "impulse", walls.metCount(), SolidImpulse{}, contact, AddImpulses{}, walls.impulse.data());
  return contact;
}

}  // namespace weir
