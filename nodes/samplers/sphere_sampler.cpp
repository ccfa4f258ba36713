#include "nodes/samplers/sphere_sampler.h"

#include <numbers>

namespace weir {

void SphereSampler::reset(const SetupContext& context) {
  const float spacing = requestedSpacing();
  // A jittered particle of the next layer may be inside.
  const float reach = radius + jitter * spacing;
  fill(context, Lattice::around(center, reach, spacing),
       [c = center.get(), r = radius.get()](const Vec3f& p) { return length(p - c) <= r; });
  warnOfRounding(context, 4 * std::numbers::pi / 3 * double(radius) * radius * radius, spacing);
  warnOfThinness(context, 2 * double(radius), spacing);
}

}  // namespace weir
