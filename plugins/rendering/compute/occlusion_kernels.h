// Ambient occlusion in the space of the picture, without OpenGL.
#pragma once

#include "plugins/rendering/compute/seen_samples.h"
#include "plugins/rendering/shading/light.h"

namespace weir::rendering {

/// Fills `open`, one number for each pixel of `samples`² samples, rows from the bottom: 1 where nothing
/// occludes. `scratch` and `distances` have its size.
template <class Backend>
void findOcclusion(Backend& device, const SeenSamples& seen, int samples, const ShadedOcclusion& occlusion,
                   ArrayView<float> open, ArrayView<float> scratch, ArrayView<float> distances);

}  // namespace weir::rendering
