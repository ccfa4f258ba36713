// How particles come into a picture. There are two ways, which give the same picture: ParticlePass, by
// OpenGL, and SplatPass, on a compute device.
#pragma once

#include <span>

#include "plugins/rendering/gl/frame.h"

namespace weir::rendering::gl {

class ParticleDrawer {
 public:
  virtual ~ParticleDrawer() = default;

  /// Takes the particles of a picture and returns the box around their spheres.
  virtual Aabb load(std::span<const ParticleView> views) = 0;
  /// Whether drawGeometry() writes all of Targets::geometry, so that it comes first, and nothing needs to be
  /// cleared before; or else it comes after the surfaces.
  virtual bool replacesAll() const = 0;
  /// Into Targets::geometry, which is bound.
  virtual void drawGeometry(const Frame& frame, const Targets& targets) = 0;
  /// Into the cleared shadow map of resolution × resolution texels, which is bound; nothing has been drawn
  /// there.
  virtual void drawShadow(const SunView& sun, const Texture& map, int resolution) = 0;
};

}  // namespace weir::rendering::gl
