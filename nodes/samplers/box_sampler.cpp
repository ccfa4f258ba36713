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

Lattice BoxSampler::lattice() const {
  const Aabb box{min, max};
  const Period filled = filledPeriod(box);
  for (int axis = 0; axis < 3; ++axis)
    if (filled.along(axis)) return Lattice::inBox(box, requestedSpacing(), makers());
  return Lattice::filling(box, requestedSpacing(), makers());
}

double BoxSampler::maxParticleCount() const {
  return static_cast<double>(lattice().size());
}

void BoxSampler::reset(const SetupContext& context) {
  const float spacing = requestedSpacing();
  const Vec3f lo = min, hi = max;
  const Lattice lattice = this->lattice();
  const Period filled = filledPeriod({lo, hi});
  const auto region = [&] {
    // The box that the particles fill: that of the whole ones' cubes, where they lie in a cubic lattice.
    Shape box;
    box.position = 0.5f * (lo + hi);
    box.halfSize = lattice.rows
                       ? 0.5f * (hi - lo)
                       : 0.5f * spacing *
                             Vec3f{static_cast<float>(lattice.count.x), static_cast<float>(lattice.count.y),
                                   static_cast<float>(lattice.count.z)};
    // Where it fills a period, it has no faces.
    for (int axis = 0; axis < 3; ++axis)
      if (filled.along(axis)) box.halfSize[axis] += filled.size[axis];
    return regionOf(context, box);
  };
  const double volume = (double(hi.x) - lo.x) * (double(hi.y) - lo.y) * (double(hi.z) - lo.z);
  fill(context, {lattice}, volume, region, {}, filled);
  warnOfStretch(context, lattice, filled);
  warnOfRounding(context, volume, spacing);
  Vec3f size = hi - lo;
  for (int axis = 0; axis < 3; ++axis)
    if (filled.along(axis)) size[axis] = std::numeric_limits<float>::infinity();
  warnOfThinness(context, std::min({size.x, size.y, size.z}), spacing);
}

}  // namespace weir
