// How much of the sky each point sees, estimated from the depths around it.
#pragma once

#include "plugins/rendering/gl/frame.h"

namespace weir::rendering::gl {

/// Scalable ambient obscurance (M. McGuire, M. Mara, D. Luebke 2012): taps on a spiral around each pixel,
/// turned by a 4×4 pattern that a blur along both axes, which keeps edges, removes.
class OcclusionPass {
 public:
  explicit OcclusionPass(const Functions& gl);

  /// Into targets.occlusion[0], for points that hem each other in within `radius` metres.
  void draw(const Frame& frame, const Targets& targets, const ShadedOcclusion& occlusion) const;
  /// All points see the whole sky.
  void clear(const Targets& targets) const;

 private:
  FullScreenProgram estimate_, blur_;
};

}  // namespace weir::rendering::gl
