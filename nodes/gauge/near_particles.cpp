#include "nodes/gauge/near_particles.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "framework/compute/dispatch.h"

namespace weir {

namespace {

constexpr double kReach = 2;        // H, spacings
constexpr double kResolution = 16;  // places of a line in a spacing
constexpr double kHalf = 0.5;       // filled as a flat surface is

Vec3d wide(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

double kernel(double squared, double reach) {
  const double h2 = reach * reach, rest = 1 - squared / h2;
  return rest > 0 ? 315 / (64 * std::numbers::pi * h2 * reach) * rest * rest * rest : 0;
}

std::vector<ParticleMatter> toHost(Device& device, const Particles& particles, const Vec3f& a, const Vec3f& b,
                                   float reach) {
  ParticleSet& set = particles.set();
  if (set.bound() == 0) return {};
  const Lease<Vec3f> room = set.leaseVectors();
  const ArrayView<int> indices{reinterpret_cast<int*>(room.data()), room.size()};
  Array<int> found(device, 1);
  found.fillZero();
  dispatch(device, [&](auto& backend) { findNear(backend, particles, a, b, reach, indices, found.data()); });
  const std::int64_t count = found.toHost().front();
  Array<ParticleMatter> gathered(device, count);
  dispatch(device, [&](auto& backend) {
    gather(backend, matterOf(particles), {indices.data, count}, gathered.view());
  });
  return gathered.toHost();
}

}  // namespace

NearParticles::NearParticles(Device& device, const Particles& particles, const Vec3f& a, const Vec3f& b)
    : a_(wide(a)),
      direction_(wide(b) - wide(a)),
      length_(length(direction_)),
      reach_(kReach * particles.material.spacing) {
  if (length_ > 0) direction_ = (1 / length_) * direction_;
  std::vector<ParticleMatter> all;
  forEachImage(particles.period, [&](const Vec3i& turns) {
    const Vec3f by = particles.period.shift(turns);
    for (ParticleMatter p : toHost(device, particles, a - by, b - by, static_cast<float>(reach_)))
      p.position += by, all.push_back(p);
  });
  std::vector<double> along(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) along[i] = dot(wide(all[i].position) - a_, direction_);
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return along[i]; });
  for (const std::size_t i : order) found_.push_back(all[i]), along_.push_back(along[i]);
}

LocalMatter NearParticles::at(double along) const {
  const double s = along * length_;
  const Vec3d place = a_ + s * direction_;
  LocalMatter sum;
  const auto first = std::ranges::lower_bound(along_, s - reach_);
  for (auto i = static_cast<std::size_t>(first - along_.begin()); i < found_.size(); ++i) {
    if (along_[i] > s + reach_) break;
    const ParticleMatter& p = found_[i];
    const Vec3d away = wide(p.position) - place;
    const double weight = double(p.volume) * kernel(dot(away, away), reach_);
    sum.filled += weight;
    sum.velocity = sum.velocity + weight * wide(p.velocity);
    sum.density += weight * double(p.density);
    sum.pressure += weight * double(p.pressure);
  }
  if (sum.filled == 0) return {};
  sum.velocity = (1 / sum.filled) * sum.velocity;
  sum.density /= sum.filled, sum.pressure /= sum.filled;
  return sum;
}

FluidOnLine fluidOnLine(const NearParticles& near, double length, double spacing) {
  constexpr double kMaxPlaces = 1e5;
  const double wanted = std::ceil(kResolution * length / spacing);
  const int parts = static_cast<int>(std::clamp(wanted, 1.0, kMaxPlaces));
  FluidOnLine found;
  double before = near.at(0).filled;
  for (int k = 1; k <= parts; ++k) {
    const double here = near.at(double(k) / parts).filled;
    const bool wasIn = before >= kHalf, isIn = here >= kHalf;
    // The share of this part that lies in fluid, as if `filled` were linear within it.
    const double share =
        wasIn == isIn ? (isIn ? 1 : 0) : (std::max(before, here) - kHalf) / std::abs(here - before);
    found.length += share * length / parts;
    if (isIn) found.height = k * length / parts;
    if (wasIn && !isIn) found.height = (k - 1 + share) * length / parts;
    before = here;
  }
  return found;
}

}  // namespace weir
