// Sums over neighbours for tests, compiled for each back end in neighbor_sum_kernel.dual.cpp.
#pragma once

#include "framework/neighbors/neighbor_list.h"

namespace weir::test {

/// sums[i] = Σ_j (d·w_j, √(d·d)) with d = positions[j] − xyz of weighted[i], w_j the last number of
/// weighted[j]. Where d is zero, d.x is 1 for j > i and −1 otherwise.
template <class Backend>
void sumPairs(Backend& device, const NeighborView& list, ArrayView<const Vec4f> weighted,
              ArrayView<const Vec3f> positions, ArrayView<Vec4f> sums);

}  // namespace weir::test
