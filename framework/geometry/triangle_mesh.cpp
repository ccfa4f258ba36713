#include "framework/geometry/triangle_mesh.h"

#include <algorithm>
#include <array>
#include <set>
#include <unordered_map>

namespace weir {

namespace {

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

bool repeatsVertex(const Vec3i& t) {
  return t.x == t.y || t.y == t.z || t.z == t.x;
}

/// The same for all triangles with the same three vertices.
std::array<int, 3> sortedKey(const Vec3i& t) {
  std::array<int, 3> key{t.x, t.y, t.z};
  std::sort(key.begin(), key.end());
  return key;
}

}  // namespace

Aabb TriangleMesh::bounds() const {
  Aabb box;
  for (const Vec3f& v : vertices) box.extend(v);
  return box;
}

double TriangleMesh::area() const {
  double sum = 0;
  for (const Vec3i& t : triangles) {
    const Vec3d a = toDouble(vertices[t.x]);
    sum += 0.5 * length(cross(toDouble(vertices[t.y]) - a, toDouble(vertices[t.z]) - a));
  }
  return sum;
}

double TriangleMesh::volume() const {
  // Relative to a point of the mesh, so that one far from the origin loses no digits.
  const Vec3d origin = vertices.empty() ? Vec3d{} : toDouble(vertices.front());
  double sum = 0;
  for (const Vec3i& t : triangles)
    sum += dot(toDouble(vertices[t.x]) - origin,
               cross(toDouble(vertices[t.y]) - origin, toDouble(vertices[t.z]) - origin));
  return sum / 6;
}

void TriangleMesh::flip() {
  for (Vec3i& t : triangles) std::swap(t.y, t.z);
}

void TriangleMesh::transform(float scale, const Quatf& rotation, const Vec3f& position) {
  for (Vec3f& v : vertices) v = rotate(rotation, scale * v) + position;
}

namespace {

/// Finds vertices within a tolerance of each other through a hash of cells of that size.
class VertexWelder {
 public:
  explicit VertexWelder(double tolerance) : tolerance_(tolerance) {}

  int add(const Vec3f& v, std::vector<Vec3f>& vertices) {
    const Vec3<std::int64_t> cell{cellOf(v.x), cellOf(v.y), cellOf(v.z)};
    for (std::int64_t dz = -1; dz <= 1; ++dz)
      for (std::int64_t dy = -1; dy <= 1; ++dy)
        for (std::int64_t dx = -1; dx <= 1; ++dx) {
          const auto [first, last] = cells_.equal_range(hash({cell.x + dx, cell.y + dy, cell.z + dz}));
          for (auto entry = first; entry != last; ++entry)
            if (length(toDouble(vertices[entry->second]) - toDouble(v)) <= tolerance_) return entry->second;
        }
    vertices.push_back(v);
    const int index = static_cast<int>(vertices.size()) - 1;
    cells_.emplace(hash(cell), index);
    return index;
  }

 private:
  std::int64_t cellOf(float x) const {
    constexpr double kMax = 1e18;
    return static_cast<std::int64_t>(std::clamp(std::floor(x / std::max(tolerance_, 1e-30)), -kMax, kMax));
  }
  static std::uint64_t hash(const Vec3<std::int64_t>& c) {
    return static_cast<std::uint64_t>(c.x) * 0x9E3779B97F4A7C15ull ^
           static_cast<std::uint64_t>(c.y) * 0xC2B2AE3D27D4EB4Full ^
           static_cast<std::uint64_t>(c.z) * 0x165667B19E3779F9ull;
  }

  double tolerance_;
  std::unordered_multimap<std::uint64_t, int> cells_;
};

}  // namespace

TriangleMesh cleaned(const TriangleMesh& mesh, float tolerance) {
  Aabb box;
  for (const Vec3f& v : mesh.vertices)
    if (isFinite(v)) box.extend(v);
  TriangleMesh clean;
  if (box.empty()) return clean;
  const double size = std::max({box.size().x, box.size().y, box.size().z});
  VertexWelder welder(tolerance * size);
  std::vector<int> newIndex(mesh.vertices.size(), -1);
  std::set<std::array<int, 3>> seen;
  for (const Vec3i& t : mesh.triangles) {
    Vec3i welded;
    bool finite = true;
    for (int k = 0; k < 3; ++k) {
      const Vec3f& v = mesh.vertices[t[k]];
      finite = finite && isFinite(v);
      if (!finite) break;
      int& index = newIndex[t[k]];
      if (index < 0) index = welder.add(v, clean.vertices);
      welded[k] = index;
    }
    if (!finite || repeatsVertex(welded) || !seen.insert(sortedKey(welded)).second) continue;
    clean.triangles.push_back(welded);
  }
  return clean;
}

}  // namespace weir
