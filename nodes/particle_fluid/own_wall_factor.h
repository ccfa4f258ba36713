// The role of a solver that takes from the integrals of walls (WallKernel) the density that is missing there
// and no pressure, so that their factor is another one.
#pragma once

namespace weir {

/// Of enabled modules of the pipeline, the first that has it is asked, at the fluid's reset.
class OwnWallFactor {
 public:
  /// a of WallKernel, such that settled water has its volume.
  virtual float wallFactor(float supportRatio) const = 0;

 protected:
  ~OwnWallFactor() = default;
};

}  // namespace weir
