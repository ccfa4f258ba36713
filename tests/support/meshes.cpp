#include "tests/support/meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace weir::test {

namespace {

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

std::array<Vec3d, 3> corners(const TriangleMesh& mesh, const Vec3i& t) {
  return {toDouble(mesh.vertices[t.x]), toDouble(mesh.vertices[t.y]), toDouble(mesh.vertices[t.z])};
}

/// Every triangle becomes four, with new vertices in the middle of its edges, moved to the sphere.
void divide(TriangleMesh& mesh, float radius) {
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto [entry, isNew] =
        middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.size()));
    if (isNew) mesh.vertices.push_back(radius * normalized(mesh.vertices[a] + mesh.vertices[b]));
    return entry->second;
  };
  std::vector<Vec3i> finer;
  for (const Vec3i& t : mesh.triangles) {
    const int xy = middle(t.x, t.y), yz = middle(t.y, t.z), zx = middle(t.z, t.x);
    finer.insert(finer.end(), {{t.x, xy, zx}, {xy, t.y, yz}, {zx, yz, t.z}, {xy, yz, zx}});
  }
  mesh.triangles = std::move(finer);
}

double squaredDistanceToSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d u = b - a;
  const double t = std::clamp(dot(p - a, u) / dot(u, u), 0.0, 1.0);
  const Vec3d d = p - (a + t * u);
  return dot(d, d);
}

/// Through barycentric coordinates of the foot, from the normal equations.
double squaredDistanceToTriangle(const Vec3d& p, const std::array<Vec3d, 3>& t) {
  const Vec3d u = t[1] - t[0], v = t[2] - t[0], w = p - t[0];
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), uw = dot(u, w), vw = dot(v, w);
  const double determinant = uu * vv - uv * uv;
  const double s = (vv * uw - uv * vw) / determinant, q = (uu * vw - uv * uw) / determinant;
  if (s >= 0 && q >= 0 && s + q <= 1) {
    const Vec3d d = w - s * u - q * v;
    return dot(d, d);
  }
  return std::min({squaredDistanceToSegment(p, t[0], t[1]), squaredDistanceToSegment(p, t[1], t[2]),
                   squaredDistanceToSegment(p, t[2], t[0])});
}

/// The angle between two unit vectors.
double angle(const Vec3d& a, const Vec3d& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

}  // namespace

TriangleMesh icosphere(int levels, float radius) {
  const float g = std::numbers::phi_v<float>;
  TriangleMesh mesh;
  for (const Vec3f& v : {Vec3f{-1, g, 0},
                         {1, g, 0},
                         {-1, -g, 0},
                         {1, -g, 0},
                         {0, -1, g},
                         {0, 1, g},
                         {0, -1, -g},
                         {0, 1, -g},
                         {g, 0, -1},
                         {g, 0, 1},
                         {-g, 0, -1},
                         {-g, 0, 1}})
    mesh.vertices.push_back(radius * normalized(v));
  // The edges have length 2 where the vertices have coordinates 1 and g: three vertices that far apart make a
  // triangle, turned so that the first is seen from outside counter-clockwise.
  const auto adjacent = [&](int a, int b) {
    return length(mesh.vertices[a] - mesh.vertices[b]) < 1.2f * radius;
  };
  for (int a = 0; a < 12; ++a)
    for (int b = a + 1; b < 12; ++b)
      for (int c = b + 1; c < 12; ++c) {
        if (!adjacent(a, b) || !adjacent(b, c) || !adjacent(c, a)) continue;
        const bool outwards = dot(cross(mesh.vertices[a], mesh.vertices[b]), mesh.vertices[c]) > 0;
        mesh.triangles.push_back(outwards ? Vec3i{a, b, c} : Vec3i{a, c, b});
      }
  for (int level = 0; level < levels; ++level) divide(mesh, radius);
  return mesh;
}

double icosphereSagitta(const TriangleMesh& sphere, double radius) {
  // A triangle is deepest at the foot of the centre in its plane.
  double deepest = 0;
  for (const Vec3i& t : sphere.triangles) {
    const auto [a, b, c] = corners(sphere, t);
    deepest = std::max(deepest, radius - dot(a, normalized(cross(b - a, c - a))));
  }
  return deepest;
}

TriangleMesh boxMesh(const Vec3f& lo, const Vec3f& hi) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriangleMesh sheet(int cells) {
  TriangleMesh mesh;
  const float step = 2.0f / static_cast<float>(cells);
  for (int y = 0; y <= cells; ++y)
    for (int x = 0; x <= cells; ++x)
      mesh.vertices.push_back({-1 + step * static_cast<float>(x), -1 + step * static_cast<float>(y), 0});
  for (int y = 0; y < cells; ++y)
    for (int x = 0; x < cells; ++x) {
      const int a = y * (cells + 1) + x, b = a + cells + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, b + 1}, {a, b + 1, b}});
    }
  return mesh;
}

void append(TriangleMesh& mesh, const TriangleMesh& added, const Vec3f& offset) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (const Vec3i& t : added.triangles) mesh.triangles.push_back(t + Vec3i{first, first, first});
  for (const Vec3f& v : added.vertices) mesh.vertices.push_back(v + offset);
}

double slowDistance(const TriangleMesh& mesh, const Vec3f& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const Vec3i& t : mesh.triangles)
    best = std::min(best, squaredDistanceToTriangle(toDouble(p), corners(mesh, t)));
  return std::sqrt(best);
}

double slowWindingNumber(const TriangleMesh& mesh, const Vec3f& p) {
  double sum = 0;
  for (const Vec3i& t : mesh.triangles) {
    auto seen = corners(mesh, t);
    for (Vec3d& v : seen) v = normalized(v - toDouble(p));
    const double a = angle(seen[1], seen[2]), b = angle(seen[2], seen[0]), c = angle(seen[0], seen[1]);
    const double s = 0.5 * (a + b + c);
    const double product =
        std::tan(s / 2) * std::tan((s - a) / 2) * std::tan((s - b) / 2) * std::tan((s - c) / 2);
    const double excess = 4 * std::atan(std::sqrt(std::max(0.0, product)));
    sum += dot(seen[0], cross(seen[1], seen[2])) < 0 ? -excess : excess;
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace weir::test
