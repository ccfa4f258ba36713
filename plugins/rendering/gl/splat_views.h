// The camera and the sun of a picture as the splat kernels know them.
#pragma once

#include "plugins/rendering/gl/frame.h"
#include "plugins/rendering/gl/splat_kernels.h"

namespace weir::rendering::gl {

/// The upper three rows of an affine map, the last column apart.
inline void setRows(const Eigen::Matrix4f& matrix, Vec3f (&rows)[3], Vec3f& moved) {
  for (int i = 0; i < 3; ++i) rows[i] = {matrix(i, 0), matrix(i, 1), matrix(i, 2)};
  moved = {matrix(0, 3), matrix(1, 3), matrix(2, 3)};
}

inline SplatCamera splatCameraOf(const Frame& frame) {
  SplatCamera camera{.tangent = frame.camera.tangent,
                     .projection = frame.camera.projectionTerms(),
                     .near = frame.camera.near,
                     .width = frame.width,
                     .height = frame.height};
  setRows(frame.camera.view, camera.rows, camera.moved);
  return camera;
}

inline SplatSun splatSunOf(const SunView& sun, int resolution) {
  SplatSun view{
      .halfSize = sun.halfSize, .zToDepth = 2 / (sun.zNearest - sun.zFarthest), .resolution = resolution};
  setRows(sun.toClip(), view.rows, view.moved);
  return view;
}

}  // namespace weir::rendering::gl
