// What liquids do to the sun's light: it is absorbed on its way through, and scattered by foam.
#pragma once

#include "plugins/rendering/gl/mesh_store.h"
#include "plugins/rendering/gl/sphere_drawer.h"
#include "plugins/rendering/gl/water_surface_pass.h"

namespace weir::rendering::gl {

class WaterShadow {
 public:
  static constexpr int kResolution = 512;  ///< texels along a side

  explicit WaterShadow(const Functions& gl) : gl_(gl) {}

  void draw(const Frame& frame, const MeshStore& meshes, SphereDrawer& particles,
            const WaterSurfacePass& surfaces) const;

  const Texture& depth() const { return depth_; }  ///< of the nearest liquid; GL_COMPARE_REF_TO_TEXTURE
  const Texture& through() const { return through_.texture; }  ///< colour of the light that comes through all

 private:
  void drawOne(const Frame& frame, std::size_t water, const MeshStore& meshes, SphereDrawer& particles,
               const WaterSurfacePass& surfaces) const;

  const Functions& gl_;
  FullScreenProgram absorb_{gl_, "water_shadow.frag"};
  Texture depth_ = makeShadowMap(gl_, kResolution);
  Texture ownDepth_{gl_, kResolution, kResolution, kDepth32F, GL_NEAREST};
  Canvas thickness_{gl_, kResolution, kResolution, kFloat2, GL_NEAREST};
  Canvas through_{gl_, kResolution, kResolution, kColor8, GL_LINEAR};
  Framebuffer ownDepthTarget_{gl_, {}, &ownDepth_}, depthTarget_{gl_, {}, &depth_};
};

}  // namespace weir::rendering::gl
