// Solids that a fluid may not enter: any number of shapes and meshes, as kernels see them.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/array.h"
#include "framework/geometry/mesh_sdf.h"
#include "framework/geometry/shape_bounds.h"
#include "framework/geometry/shapes.h"

namespace WEIR_API weir {

struct SolidImpulse;

/// One solid with its material.
struct BoundaryPiece {
  bool isMesh = false;
  Shape shape;
  MeshSdfView mesh;
  float restitution = 0;  ///< share of the normal speed that a particle keeps when it bounces
  float friction = 0;     ///< Coulomb's coefficient
  float slip = 0;         ///< share of the drag on viscous fluid that is missing
  int measured = -1;      ///< which of the boundaries that report forces it belongs to, or -1
  bool bounded = false;   ///< whether `bounds` are known
  Aabb bounds;            ///< hold the solid; of an inverted one, they lie in its room

  WEIR_HD bool inverted() const { return isMesh ? mesh.inverted : shape.inverted; }
  WEIR_HD SignedDistance query(const Vec3f& p) const {
    return isMesh ? mesh.query(p) : signedDistance(shape, p);
  }
};

/// The nearest solid of one point, or of several.
template <class T>
struct BoundaryHitOf {
  T distance{};    ///< m, negative inside the solid
  Vec3<T> normal;  ///< unit, out of the solid
  T restitution{}, friction{};
};
using BoundaryHit = BoundaryHitOf<float>;

struct BoundaryView {
  const BoundaryPiece* pieces = nullptr;
  int count = 0;
  // Mostly the only one, once more: a kernel has its parameters at hand, and waits for memory.
  BoundaryPiece first;
};

/// Calls f for every piece.
template <class F>
WEIR_HD inline void forEachPiece(const BoundaryView& boundary, const F& f) {
  if (boundary.count > 0) f(boundary.first);
  for (int k = 1; k < boundary.count; ++k) f(boundary.pieces[k]);
}

/// The union of all pieces: the smallest distance. Without pieces, everything is far away.
WEIR_HD inline BoundaryHit boundaryQuery(const BoundaryView& boundary, const Vec3f& p) {
  constexpr float kFar = 1e30f;
  BoundaryHit hit{kFar, {0, 1, 0}, 0, 0};
  forEachPiece(boundary, [&](const BoundaryPiece& piece) {
    const SignedDistance d = piece.query(p);
    if (d.distance < hit.distance) hit = {d.distance, d.normal, piece.restitution, piece.friction};
  });
  return hit;
}

/// Calls f(distance, normal) for the walls of a piece near p: the nearest point of a solid, or the faces of a
/// container.
template <class F>
WEIR_HD void forEachWall(const BoundaryPiece& piece, const Vec3f& p, const F& f) {
  const Shape& shape = piece.shape;
  if (piece.isMesh || shape.kind != ShapeKind::kBox || !shape.inverted) {
    const SignedDistance at = piece.query(p);
    return f(at.distance, at.normal);
  }
  const Vec3f local = rotate(conjugate(shape.rotation), p - shape.position), half = shape.halfSize;
  const auto faces = [&](float x, float h, const Vec3f& axis) {
    const Vec3f normal = rotate(shape.rotation, axis);
    f(h - x, -normal);
    f(h + x, normal);
  };
  faces(local.x, half.x, {1, 0, 0});
  faces(local.y, half.y, {0, 1, 0});
  faces(local.z, half.z, {0, 0, 1});
}

/// What travels along links. Pieces may be shared: a boundary that combines others holds their pieces too.
struct Boundary {
  static constexpr std::string_view kPortType = "Boundary";
  /// What a fluid asks of its boundaries.
  struct Request {
    float spacing = 0;  ///< m
    float reach = 0;    ///< m, how far from a surface distances are to be exact
    friend bool operator==(const Request&, const Request&) = default;
  };

  bool rubs = false;  ///< whether it has friction, or those that it includes have
  bool reportsForces = false;
  /// Sums, on the device, to which fluids add what they do in each step: to all of it, then to each of
  /// `parts`; null if it reports no forces.
  Array<SolidImpulse>* impulses = nullptr;
  std::vector<Aabb> parts;            ///< m; fluid that is in one pushes that part
  Vec3f pivot;                        ///< m, about which torques are counted
  std::vector<BoundaryPiece> pieces;  ///< views into `meshes` and those of combined boundaries
  std::vector<std::shared_ptr<const MeshSdf>> meshes;  ///< kept alive for the pieces
  Array<BoundaryPiece> onDevice;

  BoundaryView view() const {
    return {onDevice.data(), static_cast<int>(onDevice.size()),
            pieces.empty() ? BoundaryPiece{} : pieces.front()};
  }
};

}  // namespace weir
