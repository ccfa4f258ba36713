#include "nodes/samplers/sphere_sampler.h"

#include <algorithm>
#include <numbers>

namespace weir {

void SphereSampler::reset(const SetupContext& context) {
  const float spacing = requestedSpacing();
  // A jittered particle of the next layer may be inside.
  const float reach = radius + jitter * spacing;
  const auto region = [&] {
    Shape sphere;
    sphere.kind = ShapeKind::kSphere;
    sphere.position = center;
    sphere.radius = std::max(radius.get(), spacing);  // so that the smallest drops fit in
    return regionOf(context, sphere);
  };
  fill(context, Lattice::around(center, reach, spacing), region,
       [c = center.get(), r = radius.get()](const Vec3f& p) { return length(p - c) <= r; });
  warnOfRounding(context, 4 * std::numbers::pi / 3 * double(radius) * radius * radius, spacing);
  warnOfThinness(context, 2 * double(radius), spacing);
}

}  // namespace weir
