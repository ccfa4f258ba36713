// Whether the surfaces of two rigid meshes cross, wherever these stand.
#pragma once

#include "framework/base/api.h"
#include "framework/compute/device.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/geometry/triangle_tree.h"
#include "framework/solids/pose.h"

namespace WEIR_API weir {

/// Answers on the host.
class CrossingMesh {
 public:
  /// Keeps its own copy of the mesh.
  explicit CrossingMesh(TriangleMesh mesh);

  /// Whether an edge of the one meets a triangle of the other: so two surfaces that cross do, and one that
  /// stands whole inside the other does not. Takes a look-up for each edge that is in the other's box.
  bool crosses(const Pose& at, const CrossingMesh& other, const Pose& otherAt) const;

 private:
  bool isMetByEdges(const Pose& at, const CrossingMesh& other, const Pose& otherAt) const;

  TriangleMesh mesh_;
  CpuDevice host_{1};
  TriangleTree tree_;
};

}  // namespace weir
