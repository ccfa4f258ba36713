// Particles of a liquid by OpenGL: spheres for the surface, and rectangles that add up for the thickness.
#pragma once

#include <vector>

#include "plugins/rendering/gl/sphere_batches.h"
#include "plugins/rendering/gl/water_drawer.h"

namespace weir::rendering::gl {

class WaterParticlePass final : public WaterDrawer {
 public:
  explicit WaterParticlePass(const Functions& gl);

  Aabb load(std::span<const ParticleView> views) override;
  void drawDepth(const Frame& frame, std::size_t water, const Texture& depth) override;
  void drawThickness(const Frame& frame, std::size_t water, const Texture& front,
                     const LiquidBackground& background, const ThicknessMap& map) override;
  void drawSunDepth(const SunView& sun, std::size_t water, const Texture& depth, int resolution) override;
  void drawSunThickness(const SunView& sun, std::size_t water, const ThicknessMap& map) override;

 private:
  /// Of the particles of one view.
  struct Liquid {
    std::size_t water;
    float chord, inset;
  };

  /// Calls setUniforms(batch, liquid) before each batch of a liquid.
  template <class SetUniforms>
  void draw(const Program& program, std::size_t water, const SetUniforms& setUniforms) const;
  /// Calls setUniforms(batch) too.
  template <class SetUniforms>
  void addThickness(std::size_t water, const ThicknessMap& map, const SetUniforms& setUniforms) const;

  const Functions& gl_;
  Program depth_, sunDepth_, thickness_;
  SphereBatches batches_;
  Texture nothing_;
  std::vector<Liquid> liquids_;
};

}  // namespace weir::rendering::gl
