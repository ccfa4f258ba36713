// A node that puts out the mesh it is given.
#pragma once

#include "framework/geometry/triangle_mesh.h"
#include "framework/graph/node.h"

namespace weir::test {

class GivenMesh final : public Node {
 public:
  static constexpr NodeInfo kInfo{"GivenMesh", "A mesh of a test."};
  const NodeInfo& info() const override { return kInfo; }

  explicit GivenMesh(TriangleMesh mesh) { *surface = std::move(mesh); }
  Output<TriangleMesh> surface{*this, "surface", "The mesh."};

  void reset(const SetupContext&) override {}
};

}  // namespace weir::test
