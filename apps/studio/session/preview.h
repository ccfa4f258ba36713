// A preview of a run: the same scene with fewer, larger particles.
#pragma once

#include "framework/scene/scene.h"

namespace weir::studio {

/// Gives all fluids of a scene that is not set up yet `times` their spacing, so that a liquid has times³
/// fewer particles; emitters and samplers follow their fluids. Throws an Error if a fluid refuses that.
void coarsen(Scene& scene, int times);

}  // namespace weir::studio
