// A kernel for eight elements at a time, compiled for each back end in eight_kernel.dual.cpp.
#pragma once

#include "framework/compute/eight.h"

namespace weir::test {

/// Three arrays of one length.
struct Numbers {
  ArrayView<float> one;
  ArrayView<Vec3f> three;
  ArrayView<Vec4f> four;
};

/// Of element i: one = √one + three.y, three = three/one with 0 for a y that is not positive, four in reverse
/// plus 1 for odd i. `calls` gains 1 for each.
template <class Backend>
void changeNumbers(Backend& device, Count count, const Numbers& numbers, int* calls);

}  // namespace weir::test
