// The formulas of formulas.glsl as functions of C++: of floats, and of Numbers.
#pragma once

#include "plugins/rendering/compute/pixel_lanes.h"

namespace weir::rendering::shading {

using vec2 = Vec2f;
using vec4 = Vec4f;

template <class N>
WEIR_HD Vec2<N> couple(const N& x, const N& y) {
  return {x, y};
}
template <class N>
WEIR_HD Vec3<N> triple(const N& x, const N& y, const N& z) {
  return {x, y, z};
}

// What words.glsl says to shaders. Each formula is a template of what a real is.
#define FORMULA         \
  template <class real> \
  WEIR_HD inline
#define PLAIN WEIR_HD inline
#define CONSTANT inline constexpr
#define OUT(type) type&
#define real2 Vec2<real>
#define real3 Vec3<real>
#include "plugins/rendering/shading/formulas.glsl"
#undef FORMULA
#undef PLAIN
#undef CONSTANT
#undef OUT
#undef real2
#undef real3

}  // namespace weir::rendering::shading
