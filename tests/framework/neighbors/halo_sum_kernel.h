// A sum over neighbours for tests of halos, compiled for each back end in halo_sum_kernel.dual.cpp.
#pragma once

#include "framework/neighbors/neighbor_list.h"

namespace weir::test {

/// sums[i] = Σ_j w·(1, fields[j]) over the neighbours j of each owned particle i, w = (1 − r_ij/radius)³.
template <class Backend>
void sumFields(Backend& device, Count owned, const NeighborView& list, float radius,
               ArrayView<const Vec3f> positions, ArrayView<const Vec3f> fields, ArrayView<Vec4f> sums);

}  // namespace weir::test
