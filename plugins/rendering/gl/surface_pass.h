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

  /// Into Targets::geometry, before or after the particles, with the same result: where a surface and a
  /// particle are equally near, the particle is seen, and of two surfaces the later one, the ground last.
  void draw(const Frame& frame, const MeshStore& meshes, bool particlesAreThere);

 private:
  void drawSurface(const Frame& frame, const MeshStore& meshes, const SurfaceView& surface);
  void drawGround(const Frame& frame, GLenum depthTest);

  const Functions& gl_;
  Program program_;
  MeshStore groundMesh_;
  MeshId disc_;
};

}  // namespace weir::rendering::gl
