// The bulk modulus of a fluid whose scene gives none.
#pragma once

#include "framework/base/api.h"

namespace WEIR_API weir {

/// K, in Pa, such that a column of fluid is compressed by the tolerance at its foot, where its pressure is
/// this (Pa), and so by half of it in the mean: p/tolerance, but at least 1 MPa and at most 1 GPa. Iterations
/// that end by the tolerance know pressure to about K·tolerance, so K is no larger than that. Rounded up to
/// one digit, so that it is the same on all back ends.
double bulkModulusFor(double pressure, double tolerance);

}  // namespace weir
