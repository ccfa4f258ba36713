// From samples to lists of the spheres that are seen there, and back.
#pragma once

#include "framework/compute/array.h"
#include "plugins/rendering/compute/seen_spheres.h"

namespace weir::rendering {

/// The samples at which a sphere is seen, of those in `nearest` (gl::splatDepths), counted from its first
/// one; in *found (device memory) how many there are. `samples` has the size of `nearest`.
template <class Backend>
void findSeen(Backend& device, ArrayView<const std::uint64_t> nearest, ArrayView<int> samples, int* found);

/// Lists the spheres at samples, of which `nearest` begins with the number `first`. `ends`: where the spheres
/// of each view end.
template <class Backend>
void listSeen(Backend& device, ArrayView<const std::uint64_t> nearest, std::int64_t first,
              ArrayView<const int> samples, ArrayView<const SplatSphere> spheres,
              ArrayView<const std::int64_t> ends, ArrayView<SeenSphere> seen);

/// Puts what is seen into `nearest`, with the numbers that it has in `spheres`, of the same size.
template <class Backend>
void placeSeen(Backend& device, ArrayView<const SeenSphere> seen, ArrayView<std::uint64_t> nearest,
               ArrayView<SplatSphere> spheres);

}  // namespace weir::rendering
