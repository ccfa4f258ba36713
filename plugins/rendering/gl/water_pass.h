// Liquids over the lit scene, drawn in the space of the picture: the surface is smoothed there, bends what is
// seen through it, takes colour from it, and mirrors the surroundings (W. van der Laan, S. Green, M. Sainz
// 2009).
#pragma once

#include <functional>
#include <optional>

#include "plugins/rendering/gl/environment.h"
#include "plugins/rendering/gl/shadow_pass.h"
#include "plugins/rendering/gl/water_shadow.h"
#include "plugins/rendering/gl/water_smoothing.h"
#include "plugins/rendering/gl/water_surface_pass.h"

namespace weir::rendering::gl {

class WaterPass {
 public:
  explicit WaterPass(const Functions& gl) : gl_(gl) {}

  struct Parts {
    const MeshStore& meshes;
    SphereDrawer& particles;
    const ShadowPass& shadows;
    const WaterShadow& waterShadows;
    const WaterSurfacePass& surfaces;
    const Environment& environment;
  };

  /// Into Targets::lightWithDepth: the light where a liquid is seen, and its depth. The farthest liquid comes
  /// first. Before each, `drawBehind(depth)` is to draw what is clear and lies behind that depth, for it is
  /// seen through the liquid.
  void draw(const Frame& frame, const Targets& targets, const Parts& parts,
            const std::function<void(const Texture& depth)>& drawBehind);

 private:
  void drawOne(const Frame& frame, const Targets& targets, const Parts& parts, std::size_t water,
               const std::function<void(const Texture& depth)>& drawBehind);
  void drawMaps(const Frame& frame, const Targets& targets, const Parts& parts, std::size_t water) const;
  void drawBackground(const Frame& frame, const Targets& targets) const;
  void resolveScene(const Frame& frame, const Targets& targets) const;
  void shade(const Frame& frame, const Targets& targets, const Parts& parts, std::size_t water);
  void compose(const Frame& frame, const Targets& targets) const;

  const Functions& gl_;
  WaterSmoothing smoothing_{gl_};
  FullScreenProgram background_{gl_, "water_background.frag"};
  FullScreenProgram resolve_{gl_, "water_scene.frag"}, compose_{gl_, "water_compose.frag"};
  ProgramVariants shading_{gl_, "water.frag"};
  std::optional<WaterTargets> water_;
};

}  // namespace weir::rendering::gl
