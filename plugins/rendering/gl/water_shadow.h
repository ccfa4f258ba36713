// What liquids do to the sun's light: it is absorbed on its way through, and scattered by foam.
#pragma once

#include "plugins/rendering/gl/mesh_store.h"
#include "plugins/rendering/gl/water_drawer.h"
#include "plugins/rendering/gl/water_surface_pass.h"

namespace weir::rendering::gl {

class WaterShadow {
 public:
  static constexpr int kResolution = 512;  ///< texels along a side

  explicit WaterShadow(const Functions& gl);

  void draw(const Frame& frame, const MeshStore& meshes, WaterDrawer& particles,
            const WaterSurfacePass& surfaces) const;

  const Texture& depth() const { return depth_; }      ///< of the nearest liquid; GL_COMPARE_REF_TO_TEXTURE
  const Texture& through() const { return through_; }  ///< colour of the light that comes through all

 private:
  void drawOne(const Frame& frame, std::size_t water, const MeshStore& meshes, WaterDrawer& particles,
               const WaterSurfacePass& surfaces) const;

  const Functions& gl_;
  FullScreenProgram absorb_;
  Texture depth_, ownDepth_, thickness_, through_;
  Framebuffer ownDepthTarget_, thicknessTarget_, target_, depthTarget_;
};

}  // namespace weir::rendering::gl
