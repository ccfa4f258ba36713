// Walls in the operators of TwoProjections (two_projections.h): planes that fluid slips along.
//
// To Σ_j a·r⊗r of a particle at a distance y a plane with the normal n adds k·y·n⊗n, and to Σ_j a·(v_j −
// v_i)⊗r what keeps linear fields exact that such a wall allows: k·(n·(v_i − v_wall))·n⊗n. Layers of fluid at
// ½d, 1½d… bear an even pressure as a whole if Σ_l d·k(y_l) = 1, and each of them if k is in proportion to
// what lies behind the wall for the fluid's own kernel, −dΦ/dy with its radius H (boundary_integrals.h). What
// lies behind another wall, too, has no neighbours opposite: k is times what the others leave open, 1 − Φ.
#pragma once

#include "nodes/particle_fluid/modules/projection_packing.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir::projection {

struct WallPlane {
  Vec3f normal;    ///< away from the wall
  float distance;  ///< y, m
  float push;      ///< k, 1/m
  Vec3f velocity;  ///< of the wall, m/s
  int pair = -1;   ///< of the particle and its solid, in SolidPairs; -1 for a boundary
};

/// Solids by meshes near particles, each a plane by its ∇Φ. So where faces meet, it is a slanted one.
struct MeshPlanes {
  ArrayView<const SolidView> solids;
  SolidPairsView pairs;
  ArrayView<const Vec4f> each;
  ArrayView<const Vec3f> predicted;  ///< positions of particles, at which `each` was found
  float radius, factor;              ///< of Φ: H_w, m, and a

  /// f(distance, normal, velocity, pair)
  template <class F>
  WEIR_HD void forEach(std::int64_t i, const F& f) const {
    if (solids.size == 0) return;
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) {
      const Vec3f gradient = xyz(each[pair]);
      const float steep = sqrtf(dot(gradient, gradient));
      if (!(steep > 0)) continue;
      f(radius * distanceOf(steep * radius / factor), (-1 / steep) * gradient,
        solids[pairs.solid[pair]].velocityAt(predicted[i]), pair);
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

struct WallPlanes {
  BoundaryView boundary;
  MeshPlanes meshes;
  float radius;  ///< H, m
  float share;   ///< k over −dΦ/dy

  /// f(plane) of all that are within H of particle i, which is at x.
  template <class F>
  WEIR_HD void forEach(std::int64_t i, const Vec3f& x, const F& f) const {
    float open = 1;
    forEachWithin(i, x, [&](const FaceIntegrals<float>& face, WallPlane) { open *= 1 - face.phi; });
    forEachWithin(i, x, [&](const FaceIntegrals<float>& face, WallPlane plane) {
      plane.push = -share * face.slope / radius * open / (1 - face.phi);
      f(plane);
    });
  }

 private:
  template <class F>
  WEIR_HD void forEachWithin(std::int64_t i, const Vec3f& x, const F& f) const {
    const auto plane = [&](float distance, const Vec3f& normal, const Vec3f& velocity, int pair) {
      const float y = positivePart(distance);
      if (y < radius) f(faceIntegrals(y / radius), WallPlane{normal, y, 0, velocity, pair});
    };
    meshes.forEach(i, plane);
    if (boundary.count == 0 || !mayTouch(boundary, radius, x)) return;
    forEachPiece(boundary, [&](const BoundaryPiece& piece) {
      forEachFace(piece, x,
                  [&](float distance, const Vec3f& normal) { plane(distance, normal, Vec3f{}, -1); });
    });
  }
};

}  // namespace weir::projection
