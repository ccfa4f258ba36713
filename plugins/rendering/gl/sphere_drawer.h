// How particles come into a picture. There are two ways, which give the same picture: DrawnSpheres, by
// OpenGL, and SplattedSpheres, on a compute device.
#pragma once

#include <optional>
#include <span>

#include "plugins/rendering/gl/frame.h"

namespace weir::rendering::gl {

/// Which particles are meant, as ParticleView::water says: those of one liquid, or all that are none.
using Liquid = std::optional<std::size_t>;

/// How deep below the front of a liquid foam is seen, in radii of particles.
inline constexpr float kFoamDepth = 6;

/// What is drawn goes into whole textures into which nothing has been drawn but what clears them. They are
/// bound.
class SphereDrawer {
 public:
  virtual ~SphereDrawer() = default;

  /// Takes the particles of a picture and returns the box around their spheres.
  virtual Aabb load(std::span<const ParticleView> views) = 0;
  /// Whether drawGeometry() writes all of Targets::geometry, so that it comes first, and nothing needs to be
  /// cleared before; or else it comes after the surfaces.
  virtual bool replacesAll() const = 0;
  /// What is no liquid, into Targets::geometry.
  virtual void drawGeometry(const Frame& frame, const Targets& targets) = 0;
  /// The nearest spheres to the sun, into a square depth texture. White water is left out.
  virtual void drawSunDepth(const SunView& sun, Liquid liquid, const Texture& depth) = 0;

  /// The nearest spheres of a liquid, drawn back by ParticleView::inset(), into a depth texture of the
  /// frame's samples.
  virtual void drawDepth(const Frame& frame, std::size_t liquid, const Texture& depth) = 0;
  /// The way through a liquid in the line of sight of each texel, and of it that through foam, m (kFloat2). A
  /// particle adds its volume, spread over its sphere's picture, or over a texel if that is larger; not where
  /// it lies behind what `background` holds, which has the size of `map`: the distance along the camera's
  /// axis of what is opaque, m (kFloat1). Foam counts the less the deeper it lies behind `front`, what
  /// drawDepth() drew.
  virtual void drawThickness(const Frame& frame, std::size_t liquid, const Texture& front,
                             const Canvas& background, const Texture& map) = 0;
  /// The same as the sun sees it, all foam alike.
  virtual void drawSunThickness(const SunView& sun, std::size_t liquid, const Texture& map) = 0;
};

}  // namespace weir::rendering::gl
