// Lights the nearest surfaces, and turns the finished light into a picture.
#pragma once

#include "plugins/rendering/gl/environment.h"
#include "plugins/rendering/gl/frame.h"
#include "plugins/rendering/gl/shadow_pass.h"
#include "plugins/rendering/gl/water_shadow.h"

namespace weir::rendering::gl {

class LightingPass {
 public:
  explicit LightingPass(const Functions& gl);

  /// From targets.geometry, occlusion[0] and what the sun sees into targets.lighting. `water` is null if
  /// there is no liquid.
  void draw(const Frame& frame, const Targets& targets, const ShadowPass& shadows, const WaterShadow* water,
            const Environment& environment);

  /// From targets.light into targets.picture: the mean of each pixel's samples, with a soft shoulder instead
  /// of overexposed highlights.
  void resolve(const Frame& frame, const Targets& targets) const;

 private:
  const FullScreenProgram& programFor(const Frame& frame);

  FullScreenProgram resolve_;
  ProgramVariants lighting_;
};

}  // namespace weir::rendering::gl
