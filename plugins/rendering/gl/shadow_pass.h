// What the sun sees: the depth of the nearest opaque thing, and how much light comes through glass.
#pragma once

#include "plugins/rendering/gl/frame.h"
#include "plugins/rendering/gl/mesh_store.h"
#include "plugins/rendering/gl/sphere_drawer.h"

namespace weir::rendering::gl {

class ShadowPass {
 public:
  explicit ShadowPass(const Functions& gl) : gl_(gl) {}

  void draw(const Frame& frame, const MeshStore& meshes, SphereDrawer& particles);

  const Texture& depth() const { return depth_; }                ///< compares: GL_COMPARE_REF_TO_TEXTURE
  const Texture& throughGlass() const { return throughGlass_; }  ///< colour of the light that comes through

 private:
  const Functions& gl_;
  Program opaque_{gl_, "shadow.vert", "shadow.frag"}, glass_{gl_, "shadow.vert", "shadow_glass.frag"};
  Texture depth_ = makeShadowMap(gl_, kShadowResolution);
  Texture throughGlass_{gl_, kShadowResolution, kShadowResolution, kColor8, GL_LINEAR};
  Framebuffer depthTarget_{gl_, {}, &depth_}, glassTarget_{gl_, {&throughGlass_}, &depth_};
};

}  // namespace weir::rendering::gl
