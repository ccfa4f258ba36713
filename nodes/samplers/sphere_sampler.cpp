#include "nodes/samplers/sphere_sampler.h"

#include <algorithm>
#include <numbers>

namespace weir {

std::vector<Lattice> SphereSampler::lattices() const {
  const float spacing = requestedSpacing();
  // A jittered particle of the next layer may be inside.
  const float reach = radius + jitter * spacing;
  std::vector<Lattice> all;
  for (const Vec3<bool>& between :
       {Vec3<bool>{}, {true, true, true}, {false, false, true}, {true, true, false}})
    all.push_back(Lattice::around(center, reach, spacing, between, makers()));
  return all;
}

double SphereSampler::maxParticleCount() const {
  const double spacing = requestedSpacing(), reach = radius + jitter * spacing;
  double nodes = 0;
  for (const Lattice& lattice : lattices()) nodes = std::max(nodes, static_cast<double>(lattice.size()));
  // The cells around the nodes are in a ball that is half their diagonal larger.
  const double ball = reach / spacing + 0.5 * std::numbers::sqrt3;
  return std::min(nodes, std::floor(4 * std::numbers::pi / 3 * ball * ball * ball));
}

void SphereSampler::reset(const SetupContext& context) {
  const float spacing = requestedSpacing();
  const double volume = 4 * std::numbers::pi / 3 * double(radius) * radius * radius;
  const auto region = [&] {
    Shape sphere;
    sphere.kind = ShapeKind::kSphere;
    sphere.position = center;
    sphere.radius = std::max(radius.get(), spacing);  // so that the smallest drops fit in
    return regionOf(context, sphere);
  };
  fill(context, lattices(), volume, region,
       [c = center.get(), r = radius.get()](const Vec3f& p) { return length(p - c) <= r; });
  warnOfRounding(context, volume, spacing);
  warnOfThinness(context, 2 * double(radius), spacing);
}

}  // namespace weir
