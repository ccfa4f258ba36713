// The operators of reduce() for numbers and boxes. Sums of several things have an operator of their own
// beside them.
#pragma once

#include "framework/base/vec.h"

namespace weir {

struct Plus {
  template <class T>
  WEIR_HD T operator()(const T& a, const T& b) const {
    return a + b;
  }
};

struct Max {
  template <class T>
  WEIR_HD T operator()(const T& a, const T& b) const {
    return a > b ? a : b;
  }
};

struct UniteBoxes {
  WEIR_HD Aabb operator()(const Aabb& a, const Aabb& b) const { return {min(a.lo, b.lo), max(a.hi, b.hi)}; }
};

}  // namespace weir
