// What surrounds a scene, as the background and mirrors show it: a studio or a sky.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "plugins/rendering/gl/frame.h"

namespace weir::rendering::gl {

/// From the world to a space in which y is up.
Eigen::Matrix3f upright(const View& view);

/// "vec3 environment(vec3 direction)", in camera space. Needs kLightSnippet.
inline const std::string kEnvironmentSnippet = R"(
uniform sampler2D uSurroundings;  // all directions: around, and from below to above
uniform mat3 uToSurroundings;     // from camera space
uniform bool uAllAround;          // they have a lower half of their own

// The lower half is the ground and what it fades into.
vec3 environment(vec3 direction) {
  vec3 d = uToSurroundings * direction;
  vec2 place = vec2(atan(d.x, d.z) * 0.15915494 + 0.5, asin(clamp(d.y, -1.0, 1.0)) * 0.31830989 + 0.5);
  if (uAllAround) return textureLod(uSurroundings, place, 0.0).rgb;
  vec3 above = textureLod(uSurroundings, vec2(place.x, max(place.y, 0.503)), 0.0).rgb;
  vec3 lit = uGroundColor * (skyLight(uUp) + uSunColor * max(dot(uUp, uSun), 0.0));
  return mix(above, 0.8 * lit, smoothstep(0.0, 0.22, -d.y));
}
)";

class Environment {
 public:
  explicit Environment(const Functions& gl);

  /// Makes the surroundings of a view, if they are seen there and have changed.
  void load(const View& view);
  /// From camera space to that of the surroundings, in which y is up.
  static Eigen::Matrix3f fromCamera(const Frame& frame);
  /// The uniforms of kEnvironmentSnippet.
  void setUniforms(const Program& program, const Frame& frame, int unit) const;

 private:
  void paint(const View& view);
  void upload(const EnvironmentImage& image);

  const Functions& gl_;
  std::optional<Program> paint_;
  VertexArray array_;
  Texture surroundings_;
  std::optional<EnvironmentLook> loaded_;
  Vec3f loadedSun_;
  std::shared_ptr<const EnvironmentImage> loadedImage_;
};

}  // namespace weir::rendering::gl
