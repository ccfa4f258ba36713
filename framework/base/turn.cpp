#include "framework/base/turn.h"

#include <algorithm>
#include <cmath>

namespace weir {

double dot(const Quatf& a, const Quatf& b) {
  return double(a.w) * b.w + double(a.x) * b.x + double(a.y) * b.y + double(a.z) * b.z;
}

double shortestAngle(const Quatf& a, const Quatf& b) {
  // From the chord, as the scalar product says little of small angles. −b turns as b does.
  const double sign = dot(a, b) < 0 ? -1 : 1;
  const double w = sign * b.w - a.w, x = sign * b.x - a.x, y = sign * b.y - a.y, z = sign * b.z - a.z;
  const double chord = std::sqrt(w * w + x * x + y * y + z * z);
  return 4 * std::asin(std::min(0.5 * chord, 1.0));
}

}  // namespace weir
