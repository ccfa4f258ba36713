// How the particles of a liquid come into a picture. There are two ways, which give the same picture:
// WaterParticlePass, by OpenGL, and WaterSplatPass, on a compute device.
#pragma once

#include <span>

#include "plugins/rendering/gl/frame.h"

namespace weir::rendering::gl {

/// A map of how much liquid is in the line of sight of each texel.
struct ThicknessMap {
  const Texture& texture;  ///< kFloat2: the way through the liquid, and of it that through foam, m
  int width = 0, height = 0;
};

/// What a liquid is seen before, at each texel of a ThicknessMap.
struct LiquidBackground {
  const Texture& distance;  ///< kFloat1: of what is opaque, along the camera's axis, m
  const Framebuffer& target;
};

class WaterDrawer {
 public:
  virtual ~WaterDrawer() = default;

  /// Takes the particles of a picture that are a liquid, and returns the box around their spheres.
  virtual Aabb load(std::span<const ParticleView> views) = 0;

  // Each of the following draws the particles of one liquid, View::waters[water].

  /// The nearest spheres, drawn back by insetOf(), into a cleared depth texture of the frame's samples, which
  /// is bound; nothing has been drawn there.
  virtual void drawDepth(const Frame& frame, std::size_t water, const Texture& depth) = 0;
  /// Into a cleared map, which is bound; nothing has been drawn there. A particle adds its volume, spread
  /// over its sphere's picture, or over a texel if that is larger; not where it lies behind `background`.
  /// Foam counts the less the deeper it lies behind `front`, what drawDepth() drew.
  virtual void drawThickness(const Frame& frame, std::size_t water, const Texture& front,
                             const LiquidBackground& background, const ThicknessMap& map) = 0;
  /// The same two as the sun sees them, all foam alike.
  virtual void drawSunDepth(const SunView& sun, std::size_t water, const Texture& depth, int resolution) = 0;
  virtual void drawSunThickness(const SunView& sun, std::size_t water, const ThicknessMap& map) = 0;
};

/// Whether these particles are a liquid, and which.
inline bool isWater(const ParticleView& particles, std::size_t water) {
  return particles.water == water;
}

/// How deep below the front foam is seen, in radii of particles.
inline constexpr float kFoamDepth = 6;

/// By how much a sphere stands out from the space that its particle fills, m. Without this, liquids would
/// stand out from the walls that hold them.
float insetOf(const ParticleView& particles);

/// The way through the middle of a sphere that holds the volume of its particle, m.
float chordOf(const ParticleView& particles);

}  // namespace weir::rendering::gl
