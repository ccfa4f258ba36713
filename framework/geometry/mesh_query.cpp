#include "framework/geometry/mesh_query.h"

#include <algorithm>
#include <numbers>
#include <utility>

namespace weir {

namespace {

constexpr int kStack = BoxTree::kDepth + 1;

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}
Vec3f toFloat(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

float squaredDistance(const Aabb& box, const Vec3f& p) {
  const Vec3f out = max(max(box.lo - p, p - box.hi), Vec3f{});
  return dot(out, out);
}

/// From the origin to the segment from a to b.
double squaredDistanceToSegment(const Vec3d& a, const Vec3d& b) {
  const Vec3d along = b - a;
  const double squaredLength = dot(along, along);
  const double t = squaredLength > 0 ? std::clamp(-dot(a, along) / squaredLength, 0.0, 1.0) : 0.0;
  const Vec3d nearest = a + t * along;
  return dot(nearest, nearest);
}

/// From the origin to the triangle, or some number that is not below `best`.
double squaredDistanceToTriangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, double best) {
  const Vec3d normal = cross(b - a, c - a);
  const double squaredNormal = dot(normal, normal);
  if (squaredNormal > 0) {
    const double height = dot(a, normal);
    const double toPlane = height * height / squaredNormal;
    if (toPlane >= best) return best;
    // The origin's foot in the plane is inside if it lies left of all edges.
    if (dot(cross(a, b), normal) >= 0 && dot(cross(b, c), normal) >= 0 && dot(cross(c, a), normal) >= 0)
      return toPlane;
  }
  return std::min(
      {squaredDistanceToSegment(a, b), squaredDistanceToSegment(b, c), squaredDistanceToSegment(c, a)});
}

/// Signed solid angle of a triangle seen from the origin (Van Oosterom and Strackee 1983).
double solidAngle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double la = length(a), lb = length(b), lc = length(c);
  return 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

}  // namespace

MeshQuery::MeshQuery(const TriangleMesh& mesh) {
  BoxTree built = buildBoxTree(mesh);
  tree_ = std::move(built.nodes);
  triangles_.reserve(built.order.size());
  for (const int i : built.order) {
    const Vec3i& t = mesh.triangles[i];
    triangles_.push_back({mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]});
  }
  dipoles_.reserve(tree_.size());
  for (const BoxTree::Node& node : tree_) dipoles_.push_back(dipoleOf(node));
}

MeshQuery::Dipole MeshQuery::dipoleOf(const BoxTree::Node& node) const {
  Vec3d areaNormal, weighted;
  double area = 0;
  for (int i = node.first; i < node.last; ++i) {
    const Vec3d a = toDouble(triangles_[i][0]), b = toDouble(triangles_[i][1]),
                c = toDouble(triangles_[i][2]);
    const Vec3d normal = 0.5 * cross(b - a, c - a);
    areaNormal += normal;
    weighted += (a + b + c) * (length(normal) / 3);
    area += length(normal);
  }
  const Vec3f center = area > 0 ? toFloat(weighted / area) : node.box.center();
  float radius = 0;
  for (int i = node.first; i < node.last; ++i)
    for (const Vec3f& v : triangles_[i]) radius = std::max(radius, length(v - center));
  return {center, toFloat(areaNormal), radius};
}

float MeshQuery::closestDistance(const Vec3f& p, float atMost) const {
  if (tree_.empty()) return atMost;
  struct Pending {
    int node;
    float squared;
  };
  std::array<Pending, kStack> stack;
  int size = 0;
  double best = static_cast<double>(atMost) * atMost;
  stack[size++] = {0, squaredDistance(tree_[0].box, p)};
  const Vec3d at = toDouble(p);
  bool found = false;
  while (size > 0) {
    const Pending next = stack[--size];
    if (next.squared >= best) continue;
    const BoxTree::Node& node = tree_[next.node];
    if (node.child > 0) {
      Pending near{node.child, squaredDistance(tree_[node.child].box, p)};
      Pending far{node.child + 1, squaredDistance(tree_[node.child + 1].box, p)};
      if (far.squared < near.squared) std::swap(near, far);
      stack[size++] = far;
      stack[size++] = near;
      continue;
    }
    for (int i = node.first; i < node.last; ++i) {
      const Triangle& t = triangles_[i];
      const double squared =
          squaredDistanceToTriangle(toDouble(t[0]) - at, toDouble(t[1]) - at, toDouble(t[2]) - at, best);
      if (squared < best) best = squared, found = true;
    }
  }
  return found ? static_cast<float>(std::sqrt(best)) : atMost;
}

double MeshQuery::windingNumber(const Vec3f& p) const {
  if (tree_.empty()) return 0;
  std::array<int, kStack> stack;
  int size = 0;
  stack[size++] = 0;
  const Vec3d at = toDouble(p);
  double angle = 0;
  while (size > 0) {
    const int index = stack[--size];
    const Dipole& dipole = dipoles_[index];
    const Vec3d toCenter = toDouble(dipole.center) - at;
    const double squared = dot(toCenter, toCenter);
    const double reach = static_cast<double>(kDipoleReach) * dipole.radius;
    if (squared > reach * reach) {
      angle += dot(toDouble(dipole.areaNormal), toCenter) / (squared * std::sqrt(squared));
      continue;
    }
    const BoxTree::Node& node = tree_[index];
    if (node.child > 0) {
      stack[size++] = node.child + 1;
      stack[size++] = node.child;
      continue;
    }
    for (int i = node.first; i < node.last; ++i) {
      const Triangle& t = triangles_[i];
      angle += solidAngle(toDouble(t[0]) - at, toDouble(t[1]) - at, toDouble(t[2]) - at);
    }
  }
  return angle / (4 * std::numbers::pi);
}

}  // namespace weir
