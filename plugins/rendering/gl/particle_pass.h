// Particles as spheres with exact outlines: a rectangle around each sphere's picture, and a ray per sample.
#pragma once

#include <vector>

#include "plugins/rendering/gl/frame.h"

namespace weir::rendering::gl {

class ParticlePass {
 public:
  explicit ParticlePass(const Functions& gl);

  /// Sends the particles to the GPU and returns the box around their spheres.
  Aabb load(std::span<const ParticleView> views);

  /// Into Targets::geometry.
  void drawGeometry(const Frame& frame) const;
  /// Into the shadow map.
  void drawShadow(const SunView& sun) const;

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
