// Ambient occlusion in the space of the picture, without OpenGL: the arithmetic of gl/occlusion_pass.cpp.
#pragma once

#include "plugins/rendering/compute/seen_samples.h"

namespace weir::rendering {

struct ShadedOcclusion {
  float radius = 0;        ///< m
  float radiusInView = 0;  ///< of 1 m at a distance of 1 m, in samples
  float largest = 0;       ///< samples
};

/// Fills `open`, one number for each pixel of `samples`² samples, rows from the bottom: 1 where nothing
/// occludes. `scratch` and `distances` have its size.
template <class Backend>
void findOcclusion(Backend& device, const SeenSamples& seen, int samples, const ShadedOcclusion& occlusion,
                   ArrayView<float> open, ArrayView<float> scratch, ArrayView<float> distances);

}  // namespace weir::rendering
