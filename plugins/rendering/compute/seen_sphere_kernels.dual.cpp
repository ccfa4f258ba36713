#include "plugins/rendering/compute/seen_sphere_kernels.h"

#include "framework/compute/parallel.h"
#include "plugins/rendering/gl/splat_kernels.h"

namespace weir::rendering {

namespace {

/// Of the numbers that splats give to spheres, which count down, and back.
WEIR_HD std::uint32_t countedDown(std::uint32_t number) {
  return gl::kNoSphere - 1 - number;
}

struct IsSphere {
  ArrayView<const std::uint64_t> nearest;
  WEIR_HD bool operator()(std::int64_t k) const {
    return static_cast<std::uint32_t>(nearest[k]) != gl::kNoSphere;
  }
};

struct ListSeen {
  ArrayView<const std::uint64_t> nearest;
  std::int64_t first;
  ArrayView<const int> samples;
  ArrayView<const SplatSphere> spheres;
  ArrayView<const std::int64_t> ends;
  ArrayView<SeenSphere> seen;

  WEIR_HD void operator()(std::int64_t k) const {
    const std::uint64_t at = nearest[samples[k]];
    const std::uint32_t number = countedDown(static_cast<std::uint32_t>(at));
    std::uint32_t view = 0;
    while (number >= ends[view]) ++view;
    seen[k] = {static_cast<std::uint32_t>(first + samples[k]), static_cast<std::uint32_t>(at >> 32), view,
               spheres[number]};
  }
};

struct PlaceSeen {
  ArrayView<const SeenSphere> seen;
  ArrayView<std::uint64_t> nearest;
  ArrayView<SplatSphere> spheres;

  WEIR_HD void operator()(std::int64_t k) const {
    const SeenSphere& one = seen[k];
    nearest[one.sample] = std::uint64_t{one.depthBits} << 32 | countedDown(static_cast<std::uint32_t>(k));
    spheres[k] = one.sphere;
  }
};

}  // namespace

template <class Backend>
void findSeen(Backend& device, ArrayView<const std::uint64_t> nearest, ArrayView<int> samples, int* found) {
  compact(device, "seen spheres", nearest.size, IsSphere{nearest}, samples, found);
}

template <class Backend>
void listSeen(Backend& device, ArrayView<const std::uint64_t> nearest, std::int64_t first,
              ArrayView<const int> samples, ArrayView<const SplatSphere> spheres,
              ArrayView<const std::int64_t> ends, ArrayView<SeenSphere> seen) {
  parallelFor(device, "seen spheres", seen.size, ListSeen{nearest, first, samples, spheres, ends, seen});
}

template <class Backend>
void placeSeen(Backend& device, ArrayView<const SeenSphere> seen, ArrayView<std::uint64_t> nearest,
               ArrayView<SplatSphere> spheres) {
  parallelFor(device, "seen spheres", seen.size, PlaceSeen{seen, nearest, spheres});
}

template void findSeen(ThisBackend&, ArrayView<const std::uint64_t>, ArrayView<int>, int*);
template void listSeen(ThisBackend&, ArrayView<const std::uint64_t>, std::int64_t, ArrayView<const int>,
                       ArrayView<const SplatSphere>, ArrayView<const std::int64_t>, ArrayView<SeenSphere>);
template void placeSeen(ThisBackend&, ArrayView<const SeenSphere>, ArrayView<std::uint64_t>,
                        ArrayView<SplatSphere>);

}  // namespace weir::rendering
