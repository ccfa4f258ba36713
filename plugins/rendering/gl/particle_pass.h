// Particles as spheres with exact outlines: a rectangle around each sphere's picture, and a ray per sample.
#pragma once

#include <vector>

#include "plugins/rendering/gl/particle_drawer.h"

namespace weir::rendering::gl {

class ParticlePass final : public ParticleDrawer {
 public:
  explicit ParticlePass(const Functions& gl);

  /// Sends the particles to the GPU.
  Aabb load(std::span<const ParticleView> views) override;
  bool replacesAll() const override { return false; }
  void drawGeometry(const Frame& frame, const Targets& targets) override;
  void drawShadow(const SunView& sun, const Texture& map, int resolution) override;

 private:
  struct Batch {
    Buffer centers;
    GLsizei particles;
    float radius;
    std::size_t colors;  // index into colors_
  };

  Aabb loadOne(const ParticleView& particles);
  /// Calls setUniforms(batch) before each batch.
  template <class SetUniforms>
  void draw(const Program& program, SetUniforms setUniforms) const;

  const Functions& gl_;
  Program geometry_, shadow_;
  VertexArray array_;
  Buffer indices_;
  Texture centers_;
  std::vector<Texture> colors_;  // the colour map of each view
  int largestBatch_ = 0;
  std::vector<Batch> batches_;
  std::vector<Vec4f> packed_;  // position, and place in the colour map
};

}  // namespace weir::rendering::gl
