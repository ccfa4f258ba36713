// Integrates over a solid on a device.
#pragma once

#include "framework/compute/parallel.h"
#include "framework/solids/solid_integrals.h"

namespace weir::test {

/// out[i] = the integrals of particle points[i]; `corners` holds three corners a triangle, s = 1.
template <class Backend>
void integrateAll(Backend& device, float supportRadius, ArrayView<const Vec3f> corners,
                  ArrayView<const Vec3f> points, ArrayView<SolidIntegrals<float>> out);

}  // namespace weir::test
