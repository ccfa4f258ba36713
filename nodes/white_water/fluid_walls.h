// What a fluid meets, for white water to meet it the same: solids by signed distance, meshes that move,
// sinks, and the domain.
//
// On its way a particle is stopped by meshes exactly as the fluid's are (solid_collision.h). By signed
// distances it goes in pieces, none longer than it is far from the next wall, so it passes no wall, however
// thin that is and however fast it flies.
#pragma once

#include "nodes/particle_fluid/boundary_contact.h"
#include "nodes/particle_fluid/solid_collision.h"
#include "nodes/white_water/dragged_motion.h"

namespace weir {

struct FluidWalls {
  BoundaryView boundary;
  float contact = 0;  ///< m: how near to it a particle may come
  float exact = 0;    ///< m: farther than this from meshes, distances may be too large
  ArrayView<const SolidView> solids;
  float gap = 0;  ///< m: how near to these it may come
  ArrayView<const SinkPiece> sinks;
  Aabb domain;

  /// Whether a particle that starts at `start`, in no wall, is stopped on its way to `moved.position`; if so,
  /// moves it to where it is stopped, with the velocity after contact. `atEnd`: whether the start was seen
  /// with the solids at the end of the step.
  WEIR_HD bool stop(const Vec3f& start, bool atEnd, Motion& moved) const {
    bool stopped = boundary.count > 0 && stopAtBoundary(start, moved);
    if (solids.size == 0 || isClearOfSolids(solids, {}, atEnd, gap, start, moved.position)) return stopped;
    const StoppedParticle after = stopAtSolids(solids, {}, atEnd, gap, start, moved.position, moved.velocity);
    if (after.solid < 0) return stopped;
    moved = {after.position, after.velocity};
    // Solids may push a particle, but into no other wall.
    if (boundary.count > 0 && boundaryQuery(boundary, moved.position).distance < 0) moved.position = start;
    return true;
  }

  /// Whether a wall is within `reach` of p.
  WEIR_HD bool isNear(const Vec3f& p, float reach) const {
    if (mayTouch(boundary, reach, p) && boundaryQuery(boundary, p).distance < reach) return true;
    for (std::int64_t k = 0; k < solids.size; ++k)
      if (!(solids[k].clearance.at(solids[k].end.toBody(p)) > reach)) return true;
    return false;
  }

  /// Share of a kernel around p that lies behind walls by signed distance, with these as half-spaces.
  WEIR_HD float hidden(const Vec3f& p, float radius) const {
    if (!mayTouch(boundary, radius, p)) return 0;
    const float q = boundaryQuery(boundary, p).distance / radius, square = q * q;
    if (q >= 1 || q <= -1) return q > 0 ? 0.0f : 1.0f;
    // ∫ of 315/256·(1 − q²)⁴, which is the kernel over a plane.
    constexpr float kPlane = 315 / 256.0f;
    return 0.5f -
           kPlane * q * (1 + square * (-4 / 3.0f + square * (6 / 5.0f + square * (-4 / 7.0f + square / 9))));
  }

  WEIR_HD bool removes(const Vec3f& p) const { return !domain.contains(p) || removedBySinks(sinks, p); }

 private:
  WEIR_HD bool stopAtBoundary(const Vec3f& start, Motion& moved) const {
    constexpr int kMaxPieces = 64;
    Vec3f p = start, left = moved.position - start;
    float way = length(left);
    if (clearance(boundary, start) > way + contact) return false;
    bool touched = false;
    for (int piece = 0; piece < kMaxPieces && way > 0; ++piece) {
      const float distance = boundaryQuery(boundary, p).distance;
      const float safe = distance < exact ? distance : exact, least = 0.5f * contact;
      const float part = safe > least ? safe : least;
      const Vec3f next = part < way ? p + (part / way) * left : p + left;
      left = part < way ? (1 - part / way) * left : Vec3f{};
      p = next;
      moveOut(boundary, contact, p, [&](bool, const BoundaryHit& hit) {
        touched = true;
        moved.velocity = Collide::reflected(moved.velocity, hit);
        const float into = dot(left, hit.normal);
        if (into < 0) left -= into * hit.normal;
      });
      way = length(left);
    }
    moved.position = p;
    return touched || way > 0;
  }
};

}  // namespace weir
