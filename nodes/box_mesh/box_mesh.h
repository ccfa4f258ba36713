// A box as a triangle mesh: a block, a wall, a paddle, or a tank where it is linked as a container.
#pragma once

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/graph/node.h"

namespace WEIR_API weir {

class BoxMesh final : public Node, public OnRanks {
 public:
  static constexpr NodeInfo kInfo{"BoxMesh", "A box as a mesh: a block, a wall, a paddle or a tank.",
                                  "cube, block, wall, paddle, tank"};
  const NodeInfo& info() const override { return kInfo; }

  Param<Vec3f> min{*this, "min", {-0.5f, 0, -0.5f}, {.unit = "m", .doc = "Lower corner."}};
  Param<Vec3f> max{*this, "max", {0.5f, 1, 0.5f}, {.unit = "m", .doc = "Upper corner."}};
  Param<Rotation> rotation{
      *this, "rotation", {}, {.unit = "degrees", .doc = "Turns the box about its centre."}};

  Output<TriangleMesh> surface{*this, "surface", "The surface of 12 triangles, facing outwards."};

  void validate() const override;
  /// Makes the mesh, as others tell by it what they need.
  void estimate(const SetupContext& context, MemoryNeeds&) override { reset(context); }
  void reset(const SetupContext& context) override;
};

}  // namespace weir
