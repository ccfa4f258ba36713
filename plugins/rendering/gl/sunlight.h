// The light of the sun at a point, for the shaders of several passes: soft shadows of what is opaque, and the
// tints of glass and of liquids.
#pragma once

#include <string>

#include "plugins/rendering/gl/shadow_pass.h"
#include "plugins/rendering/gl/water_shadow.h"

namespace weir::rendering::gl {

/// The lines of #define of sunlight.glsl.
std::string sunlightDefines(const Frame& frame);

/// Its uniforms. `water` may be null if there is no liquid.
void setSunlightUniforms(const Program& program, const Frame& frame, const ShadowPass& shadows,
                         const WaterShadow* water);

}  // namespace weir::rendering::gl
