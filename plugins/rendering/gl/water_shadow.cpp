#include "plugins/rendering/gl/water_shadow.h"

namespace weir::rendering::gl {

void WaterShadow::draw(const Frame& frame, const MeshStore& meshes, SphereDrawer& particles,
                       const WaterSurfacePass& surfaces) const {
  through_.target.clearColor(0, {1, 1, 1, 1});
  depthTarget_.clearDepth();
  for (std::size_t water = 0; water < frame.view.waters.size(); ++water)
    drawOne(frame, water, meshes, particles, surfaces);
}

void WaterShadow::drawOne(const Frame& frame, std::size_t water, const MeshStore& meshes,
                          SphereDrawer& particles, const WaterSurfacePass& surfaces) const {
  const SeenWater seen{frame, water, meshes, {kResolution, kResolution}, true};
  ownDepthTarget_.clearDepth();
  setState(gl_, {.depthTest = GL_LEQUAL});
  particles.drawSunDepth(frame.sun, water, ownDepth_);
  surfaces.drawDepth(seen);

  thickness_.target.clearColor(0, {0, 0, 0, 0});
  particles.drawSunThickness(frame.sun, water, thickness_.texture);
  surfaces.drawThickness(seen);

  // The tints of several liquids are multiplied, and the nearest depth stays.
  const WaterView& view = frame.view.waters[water];
  absorb_.use();
  absorb_.setTexture("uThickness", thickness_.texture);
  absorb_.setTexture("uDepth", ownDepth_);
  absorb_.set("uExtinction", view.absorption + Vec3f{1, 1, 1} * (0.5f * view.scattering));
  absorb_.set("uFoamOpacity", view.foamOpacity);
  absorb_.set("uUneven", 0.5f * view.smoothing + 1e-6f);
  absorb_.draw(through_.target, {.source = GL_DST_COLOR});
  absorb_.draw(depthTarget_, {.depthTest = GL_LEQUAL});
}

}  // namespace weir::rendering::gl
