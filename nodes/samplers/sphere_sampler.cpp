#include "nodes/samplers/sphere_sampler.h"

#include <algorithm>
#include <numbers>

namespace weir {

double SphereSampler::maxParticleCount() const {
  const double spacing = requestedSpacing(), reach = radius + jitter * spacing;
  const double nodes =
      static_cast<double>(Lattice::around(center, static_cast<float>(reach), requestedSpacing()).size());
  // The cells around the nodes are in a ball that is half their diagonal larger.
  const double ball = reach / spacing + 0.5 * std::numbers::sqrt3;
  return std::min(nodes, std::floor(4 * std::numbers::pi / 3 * ball * ball * ball));
}

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
