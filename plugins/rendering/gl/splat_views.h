// The camera and the sun of a picture as the splat kernels know them.
#pragma once

#include "plugins/rendering/gl/frame.h"
#include "plugins/rendering/gl/splat_kernels.h"

namespace weir::rendering::gl {

inline AffineMap affineMap(const Eigen::Matrix4f& matrix) {
  const auto row = [&](int i) { return Vec3f{matrix(i, 0), matrix(i, 1), matrix(i, 2)}; };
  return {{row(0), row(1), row(2)}, {matrix(0, 3), matrix(1, 3), matrix(2, 3)}};
}

inline SplatCamera splatCameraOf(const Frame& frame) {
  return {.view = affineMap(frame.camera.view),
          .tangent = frame.camera.tangent,
          .projection = frame.camera.projectionTerms(),
          .near = frame.camera.near,
          .width = frame.width,
          .height = frame.height};
}

inline SplatSun splatSunOf(const SunView& sun, int resolution) {
  return {.toClip = affineMap(sun.toClip()),
          .halfSize = sun.halfSize,
          .zToDepth = 2 / (sun.zNearest - sun.zFarthest),
          .resolution = resolution};
}

}  // namespace weir::rendering::gl
