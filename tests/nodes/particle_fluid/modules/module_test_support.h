// What the tests of single fluid modules share.
#pragma once

#include <vector>

#include "framework/base/value.h"
#include "tests/nodes/particle_fluid/module_references.h"
#include "tests/support/devices.h"
#include "tests/support/fluid_scene.h"

namespace weir::test {

Vec3d toDouble(const Vec3f& v);
std::vector<Vec3f> randomVelocities(std::size_t count, float max, unsigned seed);
double largestDifference(const std::vector<Vec3f>& found, const std::vector<Vec3d>& expected);
Vec3d sumOf(const std::vector<Vec3f>& vectors);

/// A reference with the same particles; the fluid's settings are for the caller to make the same.
ReferenceFluid referenceWith(ReferenceFluid settings, const std::vector<Vec3f>& positions,
                             const std::vector<Vec3f>& velocities);

/// {"type": …, "after": …, "params": …}, a module to insert.
Value inserted(const char* type, const char* after, Value params);
/// {"enabled": false}
Value disabled();

}  // namespace weir::test
