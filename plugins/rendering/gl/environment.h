// What surrounds a scene, as mirrors and liquids show it.
#pragma once

#include <string>

#include "plugins/rendering/gl/frame.h"

namespace weir::rendering::gl {

/// "vec3 environment(vec3 direction)", in camera space. Needs kLightSnippet.
inline const std::string kEnvironmentSnippet = R"(
uniform vec3 uZenith, uHorizon, uBelow;

vec3 environment(vec3 direction) {
  float above = dot(direction, uUp);
  vec3 sky = mix(uHorizon, uZenith, pow(clamp(above, 0.0, 1.0), 0.55));
  return mix(uBelow, sky, smoothstep(-0.08, 0.06, above));
}
)";

void setEnvironmentUniforms(const Program& program, const Frame& frame);

}  // namespace weir::rendering::gl
