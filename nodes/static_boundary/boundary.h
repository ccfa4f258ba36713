// Solids that a fluid may not enter: any number of shapes and meshes, as kernels see them.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "framework/compute/array.h"
#include "nodes/static_boundary/mesh_sdf.h"
#include "nodes/static_boundary/shapes.h"

namespace weir {

/// One solid with its material.
struct BoundaryPiece {
  bool isMesh = false;
  Shape shape;
  MeshSdfView mesh;
  float restitution = 0;  ///< share of the normal speed that a particle keeps when it bounces
  float friction = 0;     ///< Coulomb's coefficient

  WEIR_HD SignedDistance query(const Vec3f& p) const {
    return isMesh ? mesh.query(p) : signedDistance(shape, p);
  }
};

/// The nearest solid.
struct BoundaryHit {
  float distance = 0;  ///< m, negative inside the solid
  Vec3f normal;        ///< unit, out of the solid
  float restitution = 0, friction = 0;
};

struct BoundaryView {
  const BoundaryPiece* pieces = nullptr;
  int count = 0;
  // Of the first piece, mostly the only one, once more: a kernel has its parameters at hand, and waits for
  // memory.
  bool firstIsMesh = false;
  Shape first;
};

/// The union of all pieces: the smallest distance. Without pieces, everything is far away.
WEIR_HD inline BoundaryHit boundaryQuery(const BoundaryView& boundary, const Vec3f& p) {
  constexpr float kFar = 1e30f;
  BoundaryHit hit{kFar, {0, 1, 0}, 0, 0};
  for (int k = 0; k < boundary.count; ++k) {
    const SignedDistance d = boundary.pieces[k].query(p);
    if (d.distance < hit.distance)
      hit = {d.distance, d.normal, boundary.pieces[k].restitution, boundary.pieces[k].friction};
  }
  return hit;
}

/// What travels along links. Pieces may be shared: a boundary that combines others holds their pieces too.
struct Boundary {
  static constexpr std::string_view kPortType = "Boundary";
  /// What a fluid asks of its boundaries.
  struct Request {
    float spacing = 0;  ///< m
    friend bool operator==(const Request&, const Request&) = default;
  };

  std::vector<BoundaryPiece> pieces;  ///< views into `meshes` and those of combined boundaries
  std::vector<std::shared_ptr<const MeshSdf>> meshes;  ///< kept alive for the pieces
  Array<BoundaryPiece> onDevice;

  BoundaryView view() const {
    BoundaryView view{onDevice.data(), static_cast<int>(onDevice.size())};
    if (view.count > 0) view.firstIsMesh = pieces.front().isMesh, view.first = pieces.front().shape;
    return view;
  }
};

}  // namespace weir
