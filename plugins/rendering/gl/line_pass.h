// Lines of a width in pixels, hidden by what is in front of them.
#pragma once

#include "plugins/rendering/gl/frame.h"

namespace weir::rendering::gl {

class LinePass {
 public:
  explicit LinePass(const Functions& gl);

  /// Into Targets::lightWithDepth: what lies behind the depth that `before` holds, one texel, or one per
  /// sample.
  void draw(const Frame& frame, const Targets& targets, const Texture& before) const;

 private:
  const Functions& gl_;
  Program program_;
  VertexArray array_;
  Buffer buffer_;
};

/// The two triangles (six corners in clip space) of each line that is not behind the camera.
std::vector<Vec4f> lineCorners(const Frame& frame, const LineView& lines);

}  // namespace weir::rendering::gl
