#include "nodes/fluid_surface/cube_table.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "framework/base/check.h"

namespace weir {

namespace {

constexpr int kEdgeCodes = 24;  // half of which are edges

int edgeBetween(int a, int b) {
  const int lower = std::min(a, b), step = a ^ b;
  return 3 * lower + (step == 1 ? 0 : (step == 2 ? 1 : 2));
}

/// The four corners of a face, counter-clockwise seen from outside of the cube.
using Face = std::array<int, 4>;

std::array<Face, 6> facesOfCube() {
  std::array<Face, 6> faces;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
      if (side == 0) std::swap(u, v);
      const int corner = side << axis;
      faces[2 * axis + side] = {corner, corner | u, corner | u | v, corner | v};
    }
  return faces;
}

bool shareFace(int edgeA, int edgeB) {
  const auto isOn = [](const Face& face, int edge) {
    for (int k = 0; k < 4; ++k)
      if (edgeBetween(face[k], face[(k + 1) % 4]) == edge) return true;
    return false;
  };
  for (const Face& face : facesOfCube())
    if (isOn(face, edgeA) && isOn(face, edgeB)) return true;
  return false;
}

/// For each crossed edge the one that follows on its polygon, −1 for others.
std::array<int, kEdgeCodes> polygonsOf(int cubeCase) {
  std::array<int, kEdgeCodes> next;
  next.fill(-1);
  const auto inside = [cubeCase](int corner) { return (cubeCase >> corner & 1) != 0; };
  for (const Face& face : facesOfCube())
    for (int last = 0; last < 4; ++last) {
      if (!inside(face[last]) || inside(face[(last + 1) % 4])) continue;
      // Corner `last` ends a run of inside corners; the surface comes from where the run began.
      int first = last;
      while (inside(face[(first + 3) % 4])) first = (first + 3) % 4;
      next[edgeBetween(face[(first + 3) % 4], face[first])] = edgeBetween(face[last], face[(last + 1) % 4]);
    }
  return next;
}

using Polygon = std::vector<int>;
using Triangles = std::vector<std::array<int, 3>>;

/// Triangles of the polygon's part from `first` to `last`, whose own edges may lie in faces while those
/// between them may not; nothing if there are none.
std::optional<Triangles> divided(const Polygon& polygon, int first, int last) {
  if (last - first < 2) return Triangles{};
  const auto mayJoin = [&](int a, int b) { return b - a == 1 || !shareFace(polygon[a], polygon[b]); };
  for (int k = first + 1; k < last; ++k) {
    if (!mayJoin(first, k) || !mayJoin(k, last)) continue;
    std::optional<Triangles> before = divided(polygon, first, k), after = divided(polygon, k, last);
    if (!before || !after) continue;
    before->push_back({polygon[first], polygon[k], polygon[last]});
    before->insert(before->end(), after->begin(), after->end());
    return before;
  }
  return std::nullopt;
}

Triangles trianglesOf(int cubeCase) {
  std::array<int, kEdgeCodes> next = polygonsOf(cubeCase);
  Triangles all;
  for (int start = 0; start < kEdgeCodes; ++start) {
    Polygon polygon;
    for (int edge = start; next[edge] >= 0;) {
      polygon.push_back(edge);
      edge = std::exchange(next[edge], -1);
    }
    if (polygon.empty()) continue;
    const std::optional<Triangles> triangles = divided(polygon, 0, static_cast<int>(polygon.size()) - 1);
    WEIR_CHECK(triangles.has_value());
    all.insert(all.end(), triangles->begin(), triangles->end());
  }
  return all;
}

}  // namespace

CubeTable makeCubeTable() {
  CubeTable table{};
  for (int cubeCase = 0; cubeCase < 256; ++cubeCase) {
    const Triangles triangles = trianglesOf(cubeCase);
    WEIR_CHECK(std::ssize(triangles) <= CubeTable::kMaxTriangles);
    table.triangles[cubeCase] = static_cast<unsigned char>(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int k = 0; k < 3; ++k)
        table.edges[cubeCase][3 * t + k] = static_cast<unsigned char>(triangles[t][k]);
  }
  return table;
}

}  // namespace weir
