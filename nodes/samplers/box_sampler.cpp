#include "nodes/samplers/box_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace weir {

void BoxSampler::validate() const {
  const Vec3f lo = min, hi = max;
  for (int axis = 0; axis < 3; ++axis)
    if (!(lo[axis] < hi[axis]))
      throw sceneError(
          fmt::format("the box reaches from {} to {} m along {}", lo[axis], hi[axis], "xyz"[axis]),
          "min below max along every axis")
          .inParameter(min.name());
}

double BoxSampler::maxParticleCount() const {
  return static_cast<double>(Lattice::inBox({min, max}, requestedSpacing()).size());
}

void BoxSampler::reset(const SetupContext& context) {
  const float spacing = requestedSpacing();
  const Vec3f lo = min, hi = max;
  const Lattice lattice = Lattice::inBox({lo, hi}, spacing);
  const Period filled = filledPeriod({lo, hi});
  const auto region = [&] {
    // The box that the whole particles fill: its faces are half a spacing from the outer nodes.
    Shape box;
    box.position = 0.5f * (lo + hi);
    box.halfSize = 0.5f * spacing *
                   Vec3f{static_cast<float>(lattice.count.x), static_cast<float>(lattice.count.y),
                         static_cast<float>(lattice.count.z)};
    // Where it fills a period, it has no faces.
    for (int axis = 0; axis < 3; ++axis)
      if (filled.along(axis)) box.halfSize[axis] += filled.size[axis];
    return regionOf(context, box);
  };
  fill(context, lattice, region, {}, filled);
  warnOfStretch(context, lattice, filled);
  const double volume = (double(hi.x) - lo.x) * (double(hi.y) - lo.y) * (double(hi.z) - lo.z);
  warnOfRounding(context, volume, spacing);
  Vec3f size = hi - lo;
  for (int axis = 0; axis < 3; ++axis)
    if (filled.along(axis)) size[axis] = std::numeric_limits<float>::infinity();
  warnOfThinness(context, std::min({size.x, size.y, size.z}), spacing);
}

}  // namespace weir
