#include "framework/geometry/surface_points.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "framework/base/check.h"
#include "framework/base/random.h"

namespace weir {

namespace {

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}
Vec3f toFloat(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// Twice the area times the normal.
Vec3d areaNormal(const TriangleMesh& mesh, std::size_t triangle) {
  const Vec3i& t = mesh.triangles[triangle];
  const auto corner = [&](int i) { return toDouble(mesh.vertices[static_cast<std::size_t>(i)]); };
  const Vec3d a = corner(t.x);
  return cross(corner(t.y) - a, corner(t.z) - a);
}

struct Candidates {
  std::vector<Vec3d> positions;
  std::vector<std::size_t> triangles;
};

/// `count` random points; each of `count` equal parts of the area holds one of them.
Candidates drawCandidates(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed, double& area) {
  std::vector<double> areaUpTo;
  area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    areaUpTo.push_back(area += 0.5 * length(areaNormal(mesh, t)));
  WEIR_CHECK(area > 0);
  const auto random = [&](std::size_t k) { return 0.5 * (1 + noise(seed, k)); };  // in [0, 1)
  Candidates drawn;
  for (std::size_t k = 0; k < count; ++k) {
    const double at = area * (static_cast<double>(k) + random(3 * k)) / static_cast<double>(count);
    auto found = std::upper_bound(areaUpTo.begin(), areaUpTo.end(), at);
    // Rounding may lead behind the last triangle that has an area.
    if (found == areaUpTo.end()) found = std::lower_bound(areaUpTo.begin(), areaUpTo.end(), area);
    const auto t = static_cast<std::size_t>(found - areaUpTo.begin());
    const Vec3i& corners = mesh.triangles[t];
    const auto corner = [&](int i) { return toDouble(mesh.vertices[static_cast<std::size_t>(i)]); };
    // Uniform in the triangle: the root spreads the points evenly between the corner and the far edge.
    const double root = std::sqrt(random(3 * k + 1)), v = random(3 * k + 2);
    drawn.positions.push_back((1 - root) * corner(corners.x) + root * (1 - v) * corner(corners.y) +
                              root * v * corner(corners.z));
    drawn.triangles.push_back(t);
  }
  return drawn;
}

/// Which points are closer than `radius` to each point, by a hash table of cells of that size.
class CloseTo {
 public:
  CloseTo(const std::vector<Vec3d>& points, double radius) : points_(points), radius_(radius) {
    std::size_t buckets = 1;
    while (buckets < points.size()) buckets *= 2;
    starts_.assign(buckets + 1, 0);
    for (const Vec3d& p : points) ++starts_[bucketOf(hashOfCell(p, {})) + 1];
    for (std::size_t b = 0; b < buckets; ++b) starts_[b + 1] += starts_[b];
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    entries_.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::uint64_t cell = hashOfCell(points[i], {});
      entries_[next[bucketOf(cell)]++] = {cell, i, points[i]};
    }
  }

  /// Calls f(j, distance) for every j but i.
  template <class F>
  void forEach(std::size_t i, F&& f) const {
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) scan(i, hashOfCell(points_[i], {x, y, z}), f);
  }

 private:
  struct Entry {
    std::uint64_t cell;
    std::size_t index;
    Vec3d position;
  };

  std::uint64_t hashOfCell(const Vec3d& p, const Vec3i& offset) const {
    const auto along = [this](double at, int by) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(at / radius_)) + by);
    };
    std::uint64_t h = along(p.x, offset.x) * 0x9E3779B97F4A7C15ull;
    h = (h ^ (h >> 29) ^ along(p.y, offset.y)) * 0xBF58476D1CE4E5B9ull;
    h = (h ^ (h >> 32) ^ along(p.z, offset.z)) * 0x94D049BB133111EBull;
    return h ^ (h >> 31);
  }
  std::size_t bucketOf(std::uint64_t cell) const { return cell & (starts_.size() - 2); }

  template <class F>
  void scan(std::size_t i, std::uint64_t cell, F&& f) const {
    const std::size_t bucket = bucketOf(cell);
    for (std::size_t k = starts_[bucket]; k < starts_[bucket + 1]; ++k) {
      const Entry& entry = entries_[k];
      if (entry.cell != cell || entry.index == i) continue;
      const double distance = length(entry.position - points_[i]);
      if (distance < radius_) f(entry.index, distance);
    }
  }

  const std::vector<Vec3d>& points_;
  double radius_;
  std::vector<std::size_t> starts_;  // of the entries of each bucket; their number is a power of two
  std::vector<Entry> entries_;
};

/// Marks all but `count` points as gone, the most crowded first. `reach` is twice the radius of the discs
/// that a hexagonal lattice of `count` points would have.
std::vector<bool> eliminate(const std::vector<Vec3d>& points, std::size_t count, double reach) {
  const CloseTo close(points, reach);
  const auto crowding = [reach](double distance) {
    const double near = 1 - distance / reach, squared = near * near, fourth = squared * squared;
    return fourth * fourth;
  };
  std::vector<double> weight(points.size(), 0.0);
  std::priority_queue<std::pair<double, std::size_t>> queue;
  for (std::size_t i = 0; i < points.size(); ++i) {
    close.forEach(i, [&](std::size_t, double distance) { weight[i] += crowding(distance); });
    queue.emplace(weight[i], i);
  }
  std::vector<bool> gone(points.size(), false);
  for (std::size_t left = points.size(); left > count;) {
    const auto [queued, i] = queue.top();
    queue.pop();
    // Weights only fall, so an entry that is up to date and first is the heaviest of all.
    if (queued != weight[i]) {
      queue.emplace(weight[i], i);
      continue;
    }
    gone[i] = true;
    --left;
    close.forEach(i, [&](std::size_t j, double distance) { weight[j] -= crowding(distance); });
  }
  return gone;
}

}  // namespace

SurfacePoints spreadOverSurface(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed) {
  constexpr std::size_t kDrawnPerPoint = 5;          // more makes little difference
  constexpr double kHexagonal = 1.0745699318235418;  // sqrt(2 / sqrt(3)): distances in the densest packing
  double area = 0;
  const Candidates drawn = drawCandidates(mesh, kDrawnPerPoint * count, seed, area);
  const double reach = kHexagonal * std::sqrt(area / static_cast<double>(count));
  const std::vector<bool> gone = eliminate(drawn.positions, count, reach);
  SurfacePoints spread;
  for (std::size_t i = 0; i < gone.size(); ++i) {
    if (gone[i]) continue;
    spread.positions.push_back(toFloat(drawn.positions[i]));
    spread.normals.push_back(toFloat(normalized(areaNormal(mesh, drawn.triangles[i]))));
  }
  return spread;
}

}  // namespace weir
