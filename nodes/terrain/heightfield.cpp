#include "nodes/terrain/heightfield.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/base/check.h"
#include "framework/base/random.h"

namespace weir {

namespace {

/// A number in [-1, 1) for a node of the integer lattice of an octave.
double latticeValue(std::uint64_t seed, int octave, std::int64_t i, std::int64_t k) {
  const auto index = (static_cast<std::uint64_t>(i) << 32) ^ (static_cast<std::uint64_t>(k) & 0xFFFFFFFFull);
  return noise(seed + static_cast<std::uint64_t>(octave) * 0x632BE59BD9B4E019ull, index);
}

/// 0 to 1 with flat ends, so that the noise has no creases at its lattice lines.
double smooth(double t) {
  return t * t * t * (t * (6 * t - 15) + 10);
}

/// Value noise: random values at integer points, smoothly between; in [-1, 1).
double valueNoise(std::uint64_t seed, int octave, double x, double z) {
  const double i = std::floor(x), k = std::floor(z);
  const double s = smooth(x - i), t = smooth(z - k);
  const auto at = [&](int di, int dk) {
    return latticeValue(seed, octave, static_cast<std::int64_t>(i) + di, static_cast<std::int64_t>(k) + dk);
  };
  return std::lerp(std::lerp(at(0, 0), at(1, 0), s), std::lerp(at(0, 1), at(1, 1), s), t);
}

}  // namespace

Heightfield::Heightfield(HeightfieldShape shape) : shape_(std::move(shape)) {
  WEIR_CHECK(!shape_.profile.empty());
  placeRocks();
}

double Heightfield::profileHeight(double x) const {
  const auto& p = shape_.profile;
  const auto after =
      std::upper_bound(p.begin(), p.end(), x, [](double at, const Vec2f& point) { return at < point.x; });
  if (after == p.begin()) return p.front().y;
  if (after == p.end()) return p.back().y;
  const Vec2f &a = *(after - 1), &b = *after;
  return std::lerp(double(a.y), double(b.y), (x - a.x) / (double(b.x) - a.x));
}

double Heightfield::channelCut(double z) const {
  if (shape_.channelWidth <= 0) return 0;
  const double t = std::min(std::abs(2 * z / shape_.channelWidth), 1.0);
  return shape_.channelDepth * (1 - smooth(t));
}

double Heightfield::noiseHeight(double x, double z) const {
  x += shape_.bumpOffset.x, z += shape_.bumpOffset.y;
  double sum = 0, amplitude = shape_.roughness, size = shape_.featureSize;
  for (int octave = 0; octave < shape_.octaves; ++octave, amplitude /= 2, size /= 2)
    sum += amplitude * valueNoise(shape_.seed, octave, x / size, z / size);
  return sum;
}

double Heightfield::ground(double x, double z) const {
  return profileHeight(x) - channelCut(z) + noiseHeight(x, z);
}

void Heightfield::placeRocks() {
  constexpr std::uint64_t kOfRocks = 0x9FB21C651E98DF25ull;
  constexpr double kLowest = 0.5, kTallest = 1.1;  // heights of rocks, in radii
  std::uint64_t index = 0;
  const auto draw = [&](double low, double high) {
    return std::lerp(low, high, 0.5 * (1 + noise(shape_.seed ^ kOfRocks, index++)));
  };
  for (int n = 0; n < shape_.rocks; ++n) {
    Rock rock{};
    rock.radius = draw(shape_.rockSize.x, shape_.rockSize.y);
    rock.x = draw(shape_.rockRange.x, shape_.rockRange.y);
    rock.z = draw(-0.5 * shape_.size.y, 0.5 * shape_.size.y);
    rock.height = rock.radius * draw(kLowest, kTallest);
    rocks_.push_back(rock);
  }
}

double Heightfield::height(double x, double z) const {
  double h = ground(x, z);
  for (const Rock& rock : rocks_) {
    const double r2 =
        ((x - rock.x) * (x - rock.x) + (z - rock.z) * (z - rock.z)) / (rock.radius * rock.radius);
    if (r2 < 1) h = std::max(h, ground(rock.x, rock.z) + rock.height * std::sqrt(1 - r2));
  }
  return h;
}

TriangleMesh Heightfield::solid(int cellsAlongX, int cellsAlongZ, double thickness) const {
  WEIR_CHECK((cellsAlongX > 0 && cellsAlongZ > 0 && thickness > 0));
  TriangleMesh mesh;
  double lowest = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= cellsAlongZ; ++k)
    for (int i = 0; i <= cellsAlongX; ++i) {
      const double x = shape_.size.x * (double(i) / cellsAlongX - 0.5);
      const double z = shape_.size.y * (double(k) / cellsAlongZ - 0.5);
      const double h = height(x, z);
      lowest = std::min(lowest, h);
      mesh.vertices.push_back({float(x), float(h), float(z)});
    }
  const auto top = [&](int i, int k) { return k * (cellsAlongX + 1) + i; };
  for (int k = 0; k < cellsAlongZ; ++k)
    for (int i = 0; i < cellsAlongX; ++i) {
      mesh.triangles.push_back({top(i, k), top(i, k + 1), top(i + 1, k)});
      mesh.triangles.push_back({top(i + 1, k), top(i, k + 1), top(i + 1, k + 1)});
    }

  // Walls below the rim, which goes round counter-clockwise seen from above, and a fan that closes the
  // bottom.
  std::vector<int> rim;
  for (int k = 0; k < cellsAlongZ; ++k) rim.push_back(top(0, k));
  for (int i = 0; i < cellsAlongX; ++i) rim.push_back(top(i, cellsAlongZ));
  for (int k = cellsAlongZ; k > 0; --k) rim.push_back(top(cellsAlongX, k));
  for (int i = cellsAlongX; i > 0; --i) rim.push_back(top(i, 0));
  const float bottom = float(lowest - thickness);
  const int first = int(mesh.vertices.size()), count = int(rim.size()), middle = first + count;
  for (const int v : rim) {
    const Vec3f p = mesh.vertices[std::size_t(v)];
    mesh.vertices.push_back({p.x, bottom, p.z});
  }
  mesh.vertices.push_back({0, bottom, 0});
  for (int n = 0; n < count; ++n) {
    const int next = (n + 1) % count;
    const int a = rim[std::size_t(n)], b = rim[std::size_t(next)];
    mesh.triangles.push_back({a, first + n, b});
    mesh.triangles.push_back({b, first + n, first + next});
    mesh.triangles.push_back({first + n, middle, first + next});
  }
  return mesh;
}

}  // namespace weir
