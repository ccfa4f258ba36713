#include "plugins/rendering/gl/particle_pass.h"

#include "framework/base/check.h"
#include "plugins/rendering/gl/particle_colors.h"

namespace weir::rendering::gl {

ParticlePass::ParticlePass(const Functions& gl)
    : gl_(gl),
      geometry_(gl, "sphere.vert", "particle.frag"),
      shadow_(gl, "sun_sphere.vert", "sun_sphere.frag"),
      batches_(gl) {}

Aabb ParticlePass::load(std::span<const ParticleView> views) {
  batches_.clear();
  colors_.clear();
  Aabb box;
  for (const ParticleView& view : views) {
    if (view.water) continue;
    const bool colored = !view.values.empty();
    if (colored) WEIR_CHECK(view.values.size() == view.positions.size());
    const ColorEntries entries{view.lowest, view.highest};
    // Texture coordinates of places among the texels of the colours.
    box.extend(batches_.add(view, colors_.size(), [&](std::size_t i) {
      const float entry = colored ? entries.of(view.values[i]) : float(ColorEntries::kFixed);
      return (entry + 0.5f) / float(ColorEntries::kCount);
    }));
    colors_.push_back(
        makeTexture(gl_, ColorEntries::kCount, 1, kColor8, GL_LINEAR, particleColors(view).data()));
  }
  return box;
}

void ParticlePass::drawGeometry(const Frame& frame, const Targets&) {
  batches_.draw(geometry_, [&](const SphereBatches::Batch& batch) {
    setCameraUniforms(geometry_, frame.camera, frame.width, frame.height);
    geometry_.setMatrix4("uView", frame.camera.view.data());
    geometry_.set("uNear", frame.camera.near);
    geometry_.set("uRadius", batch.radius);
    geometry_.setTexture("uColors", 1, colors_[batch.owner]);
    return true;
  });
}

void ParticlePass::drawShadow(const SunView& sun, const Texture&, int) {
  batches_.draw(shadow_, [&](const SphereBatches::Batch& batch) {
    setSunSphereUniforms(shadow_, sun, batch.radius);
    return true;
  });
}

void setSunSphereUniforms(const Program& program, const SunView& sun, float radius) {
  program.setMatrix4("uToClip", sun.toClip().eval().data());
  program.set("uRadiusInClip", radius / sun.halfSize);
  program.set("uRadiusInDepth", 2 * radius / (sun.zNearest - sun.zFarthest));
}

}  // namespace weir::rendering::gl
