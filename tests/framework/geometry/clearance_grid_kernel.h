// Looks up clearances on a device.
#pragma once

#include "framework/compute/parallel.h"
#include "framework/geometry/clearance_grid.h"

namespace weir::test {

/// out[i] = clearance.at(points[i])
template <class Backend>
void lookUpClearances(Backend& device, const ClearanceView& clearance, ArrayView<const Vec3f> points,
                      ArrayView<float> out);

}  // namespace weir::test
