// Particles as spheres with exact outlines: a rectangle around each sphere's picture, and a ray per sample.
#pragma once

#include <vector>

#include "plugins/rendering/gl/particle_drawer.h"
#include "plugins/rendering/gl/sphere_batches.h"

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
  const Functions& gl_;
  Program geometry_, shadow_;
  SphereBatches batches_;
  std::vector<Texture> colors_;  // the colour map of each view
};

/// The uniforms of sun_sphere.vert and sun_sphere.frag.
void setSunSphereUniforms(const Program& program, const SunView& sun, float radius);

}  // namespace weir::rendering::gl
