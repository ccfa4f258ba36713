// What surrounds a scene, as the background and mirrors show it: a studio or a sky.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "plugins/rendering/gl/frame.h"

namespace weir::rendering::gl {

/// From camera space to that of the surroundings, in which y is up.
Eigen::Matrix3f toSurroundings(const Frame& frame);

class Environment {
 public:
  explicit Environment(const Functions& gl);

  /// Makes the surroundings of a view, if they are seen there and have changed.
  void load(const View& view);
  /// The uniforms of environment.glsl.
  void setUniforms(const Program& program, const Frame& frame) const;

 private:
  void paint(const View& view);
  void upload(const EnvironmentImage& image);

  const Functions& gl_;
  std::optional<FullScreenProgram> paint_;
  Texture surroundings_;
  std::optional<EnvironmentLook> loaded_;
  Vec3f loadedSun_;
  std::shared_ptr<const EnvironmentImage> loadedImage_;
};

}  // namespace weir::rendering::gl
