// Walls in the operators of TwoProjections (two_projections.h): planes that fluid slips along.
//
// To Σ_j a·r⊗r of a particle at a distance y a plane with the normal n adds k·y·n⊗n, and to Σ_j a·(v_j −
// v_i)⊗r what keeps linear fields exact that such a wall allows: k·(n·(v_i − v_wall))·n⊗n. An even pressure
// must not push a particle, which it does with N·(k·n − 2·Σ_j a·r) where N is even. So k of a plane is
// 2·n·Σ_j a·r, a being the weights with those of mirrored pairs (projection_mirrors.h). In continuous fluid
// that is 6·(1 − y/H)⁵/H, with which M is 1 at the wall as well. It is not negative, and at most twice what Φ
// asks for, −4·dΦ/dy: there may be air between a particle and a wall. Where normals are
// not at right angles, each takes a part in proportion to what lies behind its plane for the fluid's own
// kernel, −dΦ/dy with its radius H (boundary_integrals.h), times what the others leave open, 1 − Φ.
#pragma once

#include "framework/base/clamped.h"
#include "nodes/particle_fluid/modules/projection_mirrors.h"
#include "nodes/particle_fluid/modules/projection_packing.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir::projection {

struct WallPlane {
  Vec3f normal;    ///< away from the wall
  float distance;  ///< y, m
  float push;      ///< k, 1/m
  float most;      ///< of k: twice that by Φ, as at y = 0
  Vec3f velocity;  ///< of the wall, m/s
  int pair = -1;   ///< of the particle and its solid, in SolidPairs; -1 for a boundary
  int number = 0;  ///< of the wall, among all
};

/// Solids by meshes near particles, each a plane by its ∇Φ. So where faces meet, it is a slanted one.
struct MeshPlanes {
  ArrayView<const SolidView> solids;
  SolidPairsView pairs;
  ArrayView<const Vec4f> each;
  ArrayView<const Vec3f> predicted;  ///< positions of particles, at which `each` was found
  float radius, factor;              ///< of Φ: H_w, m, and a

  /// f(distance, normal, velocity, pair, solid)
  template <class F>
  WEIR_HD void forEach(std::int64_t i, const F& f) const {
    if (solids.size == 0) return;
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) {
      const Vec3f gradient = xyz(each[pair]);
      const float steep = sqrtf(dot(gradient, gradient));
      if (!(steep > 0)) continue;
      f(radius * distanceOf(steep * radius / factor), (-1 / steep) * gradient,
        solids[pairs.solid[pair]].velocityAt(predicted[i]), pair, static_cast<int>(pairs.solid[pair]));
    }
  }
  /// By what Φ of a particle is more, where the solids move, than it was `dt` s ago.
  WEIR_HD float gained(std::int64_t i, float dt) const {
    if (solids.size == 0) return 0;
    float sum = 0;
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair)
      sum -= dt * dot(xyz(each[pair]), solids[pairs.solid[pair]].velocityAt(predicted[i]));
    return sum;
  }

 private:
  /// Where −dΦ/dq of a plane has that value, in radii.
  WEIR_HD static float distanceOf(float slope) {
    constexpr int kBisections = 20;
    float low = 0, high = 1;
    for (int k = 0; k < kBisections; ++k) {
      const float q = 0.5f * (low + high);
      (-faceIntegrals(q).slope > slope ? low : high) = q;
    }
    return 0.5f * (low + high);
  }
};

/// forEachWall, and of a container that is a cylinder the side and both ends.
template <class F>
WEIR_HD void forEachFace(const BoundaryPiece& piece, const Vec3f& x, const F& f) {
  const Shape& shape = piece.shape;
  if (piece.isMesh || shape.kind != ShapeKind::kCylinder || !shape.inverted) return forEachWall(piece, x, f);
  const Vec3f p = rotate(conjugate(shape.rotation), x - shape.position);
  const float r = sqrtf(p.x * p.x + p.z * p.z), half = 0.5f * shape.height;
  if (r > 0) f(shape.radius - r, rotate(shape.rotation, Vec3f{-p.x / r, 0, -p.z / r}));
  f(half - p.y, rotate(shape.rotation, Vec3f{0, -1, 0}));
  f(half + p.y, rotate(shape.rotation, Vec3f{0, 1, 0}));
}

/// The planes within H of a particle, the nearest if there are too many.
struct PlanesAtParticle {
  static constexpr int kMost = 5;
  WallPlane plane[kMost];
  int count = 0;

  WEIR_HD void add(const WallPlane& one) {
    int place = count;
    if (count == kMost) {
      place = 0;
      for (int k = 1; k < kMost; ++k)
        if (plane[k].distance > plane[place].distance) place = k;
      if (plane[place].distance <= one.distance) return;
    } else {
      ++count;
    }
    plane[place] = one;
  }
  template <class F>
  WEIR_HD void forEach(const F& f) const {
    for (int k = 0; k < count; ++k) f(plane[k]);
  }
  /// k by Φ alone.
  WEIR_HD void leaveOpen(float radius, float share) {
    float open = 1;
    forEach([&](const WallPlane& of) { open *= 1 - faceIntegrals(of.distance / radius).phi; });
    for (int k = 0; k < count; ++k) {
      const FaceIntegrals<float> face = faceIntegrals(plane[k].distance / radius);
      const float alone = -share * face.slope / radius;
      plane[k].push = alone * open / (1 - face.phi);
      plane[k].most = 2 * alone;
    }
  }
  /// Makes Σ k·n what neighbours ask for, 2·Σ a·r.
  WEIR_HD void balance(const Vec3f& asked) {
    Vec3f left = asked;
    forEach([&](const WallPlane& of) { left -= of.push * of.normal; });
    float balanced[kMost];
    for (int k = 0; k < count; ++k) {
      float all = 0;
      forEach([&](const WallPlane& of) {
        const float along = dot(of.normal, plane[k].normal);
        all += of.push * (along < 0 ? -along : along);
      });
      balanced[k] =
          all > 0 ? clamped(plane[k].push * (1 + dot(plane[k].normal, left) / all), 0, plane[k].most) : 0.0f;
    }
    for (int k = 0; k < count; ++k) plane[k].push = balanced[k];
  }
};

struct WallPlanes {
  BoundaryView boundary;
  MeshPlanes meshes;
  float radius;  ///< H, m
  float share;   ///< k over −dΦ/dy, before it is balanced

  WEIR_HD NearWalls near(std::int64_t i, const Vec3f& x) const {
    NearWalls found;
    const PlanesAtParticle all = within(i, x);
    all.forEach([&](const WallPlane& plane) { found.add(plane.distance, plane.number); });
    return found;
  }
  /// Those of particle i, which is at x and has neighbours with the sum Σ a·r.
  WEIR_HD PlanesAtParticle at(std::int64_t i, const Vec3f& x, const Vec3f& sum) const {
    PlanesAtParticle found = within(i, x);
    if (found.count == 0) return found;
    found.leaveOpen(radius, share);
    found.balance(2 * sum);
    return found;
  }

 private:
  WEIR_HD PlanesAtParticle within(std::int64_t i, const Vec3f& x) const {
    PlanesAtParticle found;
    const auto plane = [&](float distance, const Vec3f& normal, const Vec3f& velocity, int pair, int number) {
      const float y = positivePart(distance);
      if (y < radius) found.add(WallPlane{normal, y, 0, 0, velocity, pair, number});
    };
    meshes.forEach(i, plane);
    if (boundary.count == 0 || !mayTouch(boundary, radius, x)) return found;
    int number = static_cast<int>(meshes.solids.size);
    forEachPiece(boundary, [&](const BoundaryPiece& piece) {
      forEachFace(piece, x, [&](float distance, const Vec3f& normal) {
        plane(distance, normal, Vec3f{}, -1, number++);
      });
    });
    return found;
  }
};

}  // namespace weir::projection
