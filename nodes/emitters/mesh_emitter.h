// Emission from a surface. A layer is round(area/spacing²) points, spread evenly over the triangles by area
// at distances of about the spacing; each moves along the normal of its triangle, to the side from which the
// triangle's corners run counter-clockwise. All layers have the same points, so that particles are a spacing
// apart along the normals as well.
#pragma once

#include "framework/base/api.h"
#include "framework/geometry/triangle_mesh.h"
#include "nodes/emitters/emitter.h"

namespace WEIR_API weir {

class MeshEmitter final : public Emitter {
 public:
  static constexpr NodeInfo kInfo{
      "MeshEmitter", "Emits particles from the surface of a mesh, along the normals of its triangles.",
      "jet, inflow, inlet, source, rain, pour"};
  const NodeInfo& info() const override { return kInfo; }

  Input<TriangleMesh> surface{*this, "surface", "The mesh to emit from; it may be open."};

 protected:
  double area() const override { return surface->area(); }
  double layerSize(float spacing) const override;
  Layer makeLayer(const SetupContext& context, float spacing) const override;
  double maxInLayer() const override { return 1e6; }  // spreading a million takes about a minute
};

}  // namespace weir
