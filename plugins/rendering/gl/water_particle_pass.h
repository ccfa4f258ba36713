// Particles of a liquid by OpenGL: spheres for the surface, and rectangles that add up for the thickness.
#pragma once

#include <vector>

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
  struct Batch {
    Buffer centers;
    GLsizei particles;
    std::size_t water;
    float radius, volumeOfSphere, inset;
  };

  Aabb loadOne(const ParticleView& particles);
  /// Calls setUniforms(batch) before each batch of a liquid.
  template <class SetUniforms>
  void draw(const Program& program, std::size_t water, SetUniforms setUniforms) const;
  /// Calls setUniforms(batch) too.
  template <class SetUniforms>
  void addThickness(std::size_t water, const ThicknessMap& map, SetUniforms setUniforms) const;

  const Functions& gl_;
  Program depth_, sunDepth_, thickness_;
  VertexArray array_;
  Buffer indices_;
  Texture centers_, nothing_;
  int largestBatch_ = 0;
  std::vector<Batch> batches_;
  std::vector<Vec4f> packed_;  // position, and part of foam
};

}  // namespace weir::rendering::gl
