// How particles are stopped at rigid meshes, and how that is told to the solids.
#pragma once

#include "framework/geometry/sweep.h"
#include "nodes/particle_fluid/body_coupling.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/fluid_sums.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

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

/// Whether the ball about the origin of the solid's frame that holds its mesh is farther than `gap` from a
/// particle's way for certain: without turning anything, as most solids are far from most particles.
WEIR_HD inline bool isFar(const SolidView& solid, const Pose& at, float gap, const Vec3f& start,
                          const Vec3f& position) {
  if (solid.clearance.steps.size == 0) return false;
  const Aabb& box = solid.clearance.bounds;
  const float radius = length(max(max(box.lo, -1 * box.lo), max(box.hi, -1 * box.hi)));
  const Vec3f from = start - at.translation, to = position - solid.end.translation;
  const Quatf &p = at.rotation, &q = solid.end.rotation;
  const float w = q.w - p.w, x = q.x - p.x, y = q.y - p.y, z = q.z - p.z;
  // A turn moves a point by at most twice its distance times the difference of the quaternions.
  const float turned = 2 * std::sqrt(w * w + x * x + y * y + z * z) * length(from);
  constexpr float kRounding = 1e-5f;
  const float distance = length(to);
  const float near = radius + gap + kRounding * (radius + distance + length(from));
  return distance - near > length(to - from) + turned;
}

/// Whether nothing of any solid can be near a particle's way; the same start and position as of stopAtSolids.
WEIR_HD inline bool isClearOfSolids(ArrayView<const SolidView> solids, const SolidGridView& grid, bool atEnd,
                                    float gap, const Vec3f& start, const Vec3f& position) {
  const NearSolids near = grid.near(position, length(position - start), solids.size);
  for (int k = near.from(0); k < near.count; k = near.from(k + 1)) {
    const SolidView& solid = solids[k];
    const Pose& begin = atEnd ? solid.predicted : solid.begin;
    if (isFar(solid, begin, gap, start, position)) continue;
    const Vec3f from = begin.toBody(start);
    if (!isClear(solid.tree, solid.clearance, from, solid.end.toBody(position), gap)) return false;
  }
  return true;
}

/// From `start`, as it was when the solids were at their `begin` (or, if `atEnd`, where they were predicted),
/// to the particle's position at their end. A solid that stops it may bring it near others.
WEIR_HD inline StoppedParticle stopAtSolids(ArrayView<const SolidView> solids, const SolidGridView& grid,
                                            bool atEnd, float gap, const Vec3f& start, const Vec3f& position,
                                            const Vec3f& velocity) {
  // Leaving one solid may mean entering another.
  constexpr int kPasses = 4;
  StoppedParticle particle{position, velocity};
  NearSolids near = grid.near(position, length(position - start), solids.size);
  for (int pass = 0; pass < kPasses; ++pass) {
    bool stopped = false;
    for (int k = near.from(0); k < near.count; k = near.from(k + 1)) {
      const SolidView& solid = solids[k];
      const Vec3f from = (atEnd ? solid.predicted : solid.begin).toBody(start);
      const SweepResult way =
          sweep(solid.tree, solid.clearance, from, solid.end.toBody(particle.position), gap);
      if (!way.hit) continue;
      stopped = true;
      particle.position = solid.end.toWorld(way.position);
      particle.velocity = velocityAfterContact(particle.velocity, solid.velocityAt(particle.position),
                                               solid.end.directionToWorld(way.normal), solid.friction);
      particle.solid = k;
      near = grid.near(particle.position, length(particle.position - start), solids.size);
    }
    if (!stopped || solids.size == 1) return particle;
  }
  particle.position = start;  // between solids that leave no room
  return particle;
}

struct AddImpulses {
  WEIR_HD SolidImpulse operator()(SolidImpulse a, const SolidImpulse& b) const { return a += b; }
};

/// Adds sums to that of solid k, which stand at k, k + their number, …
struct GiveImpulse {
  ArrayView<const SolidView> solids;
  ArrayView<const SolidImpulse> sums;
  WEIR_HD void operator()(std::int64_t k) const {
    for (std::int64_t s = k; s < sums.size; s += solids.size) {
      *solids[k].impulse += sums[s];
      if (FreeBody* body = solids[k].body; body != nullptr && body->placed) body->received += sums[s];
    }
  }
};

WEIR_HD inline SolidImpulse impulseAt(const Vec3f& impulse, const Vec3f& arm) {
  const Vec3d j{impulse.x, impulse.y, impulse.z}, r{arm.x, arm.y, arm.z};
  return {j, cross(r, j)};
}

/// What solids feel of the contact of particle met[i].
struct ContactImpulse {
  ArrayView<const SolidView> solids;
  float mass;
  ArrayView<const int> met;
  ArrayView<const Vec3f> positions;
  ArrayView<const Vec4f> kick;

  template <class Give>
  WEIR_HD void operator()(std::int64_t i, const Give& give) const {
    const Vec4f at = kick[i];
    const int k = static_cast<int>(at.w);
    if (k < 0) return;
    give(k, [&] { return impulseAt(-mass * xyz(at), positions[met[i]] - solids[k].pivot); });
  }
};

/// Sums what solid k feels of contact into walls.impulses[k].
template <class Backend>
void sumContacts(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  sumByKeyOverRanks(device, "impulse", {ranksOf(fluid), walls.metCount(), walls.hitsBySolid()},
                    walls.views.size(),
                    ContactImpulse{std::as_const(walls.views).view(), fluid.constants.particleMass,
                                   std::as_const(walls.met).view(), fluid.particles.positions().read(),
                                   std::as_const(walls.kick).view()},
                    AddImpulses{}, walls.impulses.data());
}

/// Gives the solids the first `sums` of walls.impulses that each has.
template <class Backend>
void giveImpulses(Backend& device, WallField& walls, int sums) {
  const std::int64_t solids = walls.views.size();
  parallelFor(device, "add impulses", solids,
              GiveImpulse{std::as_const(walls.views).view(), {walls.impulses.data(), sums * solids}});
}

}  // namespace weir
