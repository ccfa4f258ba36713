#include "plugins/views/velocity_arrows.h"

#include <array>
#include <cmath>
#include <map>

#include "framework/base/check.h"
#include "plugins/views/shown_particles.h"

namespace weir::rendering {

namespace {

struct Sums {
  Vec3d place, velocity;
  int count = 0;
};

Vec3d inDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

Vec3f meanOf(const Vec3d& sum, int count) {
  const Vec3d mean = sum / static_cast<double>(count);
  return {static_cast<float>(mean.x), static_cast<float>(mean.y), static_cast<float>(mean.z)};
}

/// A shaft and the two sides of a head that is flat to the eye.
void addArrow(const Vec3f& from, const Vec3f& way, const Vec3f& eye, std::vector<Vec3f>& lines) {
  constexpr float kHead = 0.28f, kHalfWidth = 0.12f;  // of the length
  const Vec3f to = from + way;
  const Vec3f across = normalized(cross(way, eye - to)) * (kHalfWidth * length(way));
  const Vec3f neck = to - way * kHead;
  lines.insert(lines.end(), {from, to, to, neck + across, to, neck - across});
}

}  // namespace

void addVelocityArrows(std::span<const Vec3f> positions, std::span<const Vec3f> velocities,
                       std::span<const Cut> cuts, float spacing, float seconds, const Vec3f& eye,
                       std::vector<Vec3f>& lines) {
  WEIR_CHECK(positions.size() == velocities.size());
  std::map<std::array<std::int64_t, 3>, Sums> cubes;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3f &p = positions[i], &v = velocities[i];
    if (!isFinite(p) || !isFinite(v) || !isShown(cuts, p)) continue;
    const auto cell = [&](float x) { return static_cast<std::int64_t>(std::floor(double{x} / spacing)); };
    Sums& sums = cubes[{cell(p.x), cell(p.y), cell(p.z)}];
    sums.place += inDouble(p);
    sums.velocity += inDouble(v);
    ++sums.count;
  }
  for (const auto& [cell, sums] : cubes) {
    const Vec3f place = meanOf(sums.place, sums.count);
    const Vec3f way = meanOf(sums.velocity, sums.count) * seconds;
    const float distance = length(eye - place);
    constexpr float kShortest = 0.05f;  // of the spacing, to be seen
    if (length(way) < kShortest * spacing || !(distance > 2 * spacing)) continue;
    const float nearer = 1 - spacing / distance;
    addArrow(eye + (place - eye) * nearer, way * nearer, eye, lines);
  }
}

}  // namespace weir::rendering
