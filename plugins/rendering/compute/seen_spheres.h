// The spheres that are seen in a picture, of one rank or of all: what ranks send rank 0 in place of their
// particles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "framework/base/vec.h"
#include "framework/communication/communicator.h"
#include "plugins/rendering/compute/sphere_kernels.h"

namespace weir::rendering {

/// A sphere at a sample where it is the nearest of its rank.
struct SeenSphere {
  std::uint32_t sample = 0;  ///< row by row from the bottom
  std::uint32_t depthBits = 0;
  std::uint32_t view = 0;  ///< whose it is, in the order of SphereSet::opaqueEnds()
  SplatSphere sphere;
};

/// What a picture shows of the spheres of all ranks.
struct SeenOfRanks {
  Aabb casters;                       ///< around the spheres of all, those that are not seen included; m
  float largestRadius = 0;            ///< of these, m; 0 without any
  std::vector<SeenSphere> spheres;    ///< by sample
  std::vector<std::uint32_t> shadow;  ///< the shadow map, bits of depths; empty without shadows
};

/// The nearer one at each sample, by sample, as both are. Where two are equally near, it is that of the later
/// view, and of one view that of `later`: the last one, if the particles of a view stand rank by rank.
std::vector<SeenSphere> nearestOf(std::span<const SeenSphere> earlier, std::span<const SeenSphere> later);

/// On rank 0 the nearest of what each rank has there, on others what they have. All ranks take part.
std::vector<SeenSphere> nearestOfRanks(Communicator& ranks, std::vector<SeenSphere> own);
/// The same for the depths of shadow maps.
std::vector<std::uint32_t> nearestOfRanks(Communicator& ranks, std::vector<std::uint32_t> own);

}  // namespace weir::rendering
