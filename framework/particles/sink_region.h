// Where fluid vanishes, as kernels see it.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/parallel.h"
#include "framework/geometry/mesh_sdf.h"

namespace WEIR_API weir {

/// A box, or the part of it that is inside a mesh.
struct SinkPiece {
  Aabb box;
  bool isMesh = false;
  MeshSdfView mesh;
  int* removed = nullptr;  ///< counts on the device; shared by the pieces of one sink

  WEIR_HD bool contains(const Vec3f& p) const {
    return box.contains(p) && (!isMesh || mesh.query(p).distance < 0);
  }
};

/// Whether one of the pieces contains p; the first that does counts it.
WEIR_HD inline bool removedBySinks(ArrayView<const SinkPiece> sinks, const Vec3f& p) {
  for (std::int64_t k = 0; k < sinks.size; ++k) {
    if (!sinks[k].contains(p)) continue;
    atomicAdd(sinks[k].removed, 1);
    return true;
  }
  return false;
}

/// What travels along links.
struct SinkRegion {
  static constexpr std::string_view kPortType = "SinkRegion";
  /// What a fluid asks of its sinks.
  struct Request {
    float spacing = 0;  ///< m
    friend bool operator==(const Request&, const Request&) = default;
  };

  std::vector<SinkPiece> pieces;                       ///< views into `meshes`
  std::vector<std::shared_ptr<const MeshSdf>> meshes;  ///< kept alive for the pieces
};

}  // namespace weir
