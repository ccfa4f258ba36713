// A box as a mesh: plates, paddles, steps and tanks for whatever takes meshes.
#pragma once

#include "framework/graph/node.h"
#include "nodes/geometry/triangle_mesh.h"

namespace weir {

class BoxMesh final : public Node {
 public:
  static constexpr NodeInfo kInfo{"BoxMesh", "A box as a mesh, such as a plate or a paddle."};
  const NodeInfo& info() const override { return kInfo; }

  Param<Vec3f> size{*this, "size", {1, 1, 1}, {.unit = "m", .doc = "Lengths of its edges, above 0."}};
  Param<Vec3f> position{*this, "position", {}, {.unit = "m", .doc = "Where its middle is."}};
  Param<Rotation> rotation{*this, "rotation", {}, {.unit = "degrees", .doc = "Turns it about its middle."}};

  Output<TriangleMesh> surface{*this, "surface", "The surface, facing outwards."};

  void validate() const override;
  void reset(const SetupContext& context) override;
};

}  // namespace weir
