// Makes one smooth surface of the spheres of a liquid, and one smooth map of its thickness.
#pragma once

#include "plugins/rendering/gl/frame.h"

namespace weir::rendering::gl {

/// What the passes of a liquid share; one value per pixel where nothing else is said.
struct WaterTargets {
  WaterTargets(const Functions& gl, const Targets& targets);

  Texture depth, normal;  ///< per sample; normals with an alpha of 1 where a mesh is seen
  Framebuffer surface;
  Canvas background;    ///< distance of what is opaque, at half the size
  Canvas thickness[2];  ///< at half the size
  /// One over the distance along the camera's axis, which is linear on planes; 0 where there is none, below 0
  /// where a mesh is seen.
  Canvas nearness[2];
  Canvas scene, shaded;  ///< linear light
};

class WaterSmoothing {
 public:
  explicit WaterSmoothing(const Functions& gl);

  /// From water.depth and water.normal into water.nearness[1]. What lies far behind is drawn towards the
  /// pixel in the middle, and what lies far before is left out, so that outlines stay sharp (narrow-range
  /// filter of N. Truong, C. Yuksel 2018). `width` is that of the Gaussian weight, m.
  void smoothSurface(const Frame& frame, const WaterTargets& water, float width) const;
  /// water.thickness[0], in place. `width` in m at the distance of the surface.
  void smoothThickness(const Frame& frame, const WaterTargets& water, float width) const;

 private:
  FullScreenProgram gather_, narrowRange_, polish_, blur_;
};

}  // namespace weir::rendering::gl
