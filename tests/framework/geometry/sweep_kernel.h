// Moves points against a mesh on a device.
#pragma once

#include "framework/compute/parallel.h"
#include "framework/geometry/sweep.h"

namespace weir::test {

struct Motion {
  Vec3f from, to, towards;
};

/// out[i] = sweep(tree, clearance, motions[i], thickness)
template <class Backend>
void sweepAll(Backend& device, const TriangleTreeView& tree, const ClearanceView& clearance, float thickness,
              ArrayView<const Motion> motions, ArrayView<SweepResult> out);

}  // namespace weir::test
