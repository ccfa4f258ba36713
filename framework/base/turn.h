// How far two rotations are apart.
#pragma once

#include "framework/base/vec.h"

namespace weir {

/// The scalar product of two quaternions.
double dot(const Quatf& a, const Quatf& b);
/// The angle in [0, π], in rad, of the turn that leads from one quaternion of length 1 to the other.
double shortestAngle(const Quatf& a, const Quatf& b);

}  // namespace weir
