// What the sun sees: the depth of the nearest opaque thing, and how much light comes through glass.
#pragma once

#include "plugins/rendering/gl/frame.h"
#include "plugins/rendering/gl/mesh_store.h"
#include "plugins/rendering/gl/sphere_drawer.h"

namespace weir::rendering::gl {

class ShadowPass {
 public:
  explicit ShadowPass(const Functions& gl);

  void draw(const Frame& frame, const MeshStore& meshes, SphereDrawer& particles);

  const Texture& depth() const { return depth_; }                ///< compares: GL_COMPARE_REF_TO_TEXTURE
  const Texture& throughGlass() const { return throughGlass_; }  ///< colour of the light that comes through

 private:
  const Functions& gl_;
  Program opaque_, glass_;
  Texture depth_, throughGlass_;
  Framebuffer depthTarget_, glassTarget_;
};

}  // namespace weir::rendering::gl
