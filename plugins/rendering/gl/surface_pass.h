// Opaque surfaces and the ground.
#pragma once

#include "plugins/rendering/gl/frame.h"
#include "plugins/rendering/gl/mesh_store.h"

namespace weir::rendering::gl {

/// Sets uToView (mat4) and uNormalToView (mat3) of a program to where a surface is.
void setPlacement(const Program& program, const Camera& camera, const SurfaceView& surface);

/// From a mesh's own space to the world.
Eigen::Matrix4f placementOf(const SurfaceView& surface);
/// The box around a placed mesh.
Aabb placedBounds(const Aabb& bounds, const SurfaceView& surface);

class SurfacePass {
 public:
  explicit SurfacePass(const Functions& gl);

  /// Into Targets::geometry.
  void draw(const Frame& frame, const MeshStore& meshes);

 private:
  void drawGround(const Frame& frame);

  const Functions& gl_;
  Program program_;
  MeshStore groundMesh_;
  MeshId disc_;
};

}  // namespace weir::rendering::gl
