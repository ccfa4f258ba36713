#include "framework/geometry/pseudo_normals.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <tuple>

namespace weir {

namespace {

/// Sums of unit normals below this cancel; what is left is rounding of the vertices.
constexpr double kCancelled = 1e-6;

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}
Vec3f toFloat(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// For each vertex, the first vertex in the order of the coordinates that is at the same place.
std::vector<int> weld(const std::vector<Vec3f>& vertices) {
  std::vector<int> order(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) { return std::tie(vertices[i].x, vertices[i].y, vertices[i].z); };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  std::vector<int> welded(vertices.size());
  int same = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || !(vertices[order[i]] == vertices[same])) same = order[i];
    welded[order[i]] = same;
  }
  return welded;
}

struct EdgeUse {
  std::uint64_t ends;  // both welded vertices, the smaller one first
  int triangle, edge;
};

Vec3f direction(const Vec3d& sum, double weight, const Vec3d& otherwise) {
  return toFloat(length(sum) > kCancelled * weight ? normalized(sum) : otherwise);
}

double angleBetween(const Vec3d& a, const Vec3d& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

class NormalSums {
 public:
  explicit NormalSums(const TriangleMesh& mesh) : mesh_(mesh), welded_(weld(mesh.vertices)) {
    faces_.reserve(mesh.triangles.size());
    for (const Vec3i& t : mesh.triangles) {
      const Vec3d a = toDouble(mesh.vertices[t.x]);
      faces_.push_back(normalized(cross(toDouble(mesh.vertices[t.y]) - a, toDouble(mesh.vertices[t.z]) - a)));
    }
  }

  void setFaces(std::vector<PseudoNormals>& out) const {
    for (std::size_t i = 0; i < out.size(); ++i) out[i].normals[PseudoNormals::kFace] = toFloat(faces_[i]);
  }

  void setCorners(std::vector<PseudoNormals>& out) const {
    std::vector<Vec3d> sums(mesh_.vertices.size());
    std::vector<double> weights(mesh_.vertices.size());
    for (std::size_t i = 0; i < out.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const Vec3i& t = mesh_.triangles[i];
        const Vec3d at = toDouble(mesh_.vertices[t[k]]);
        const double angle = angleBetween(toDouble(mesh_.vertices[t[(k + 1) % 3]]) - at,
                                          toDouble(mesh_.vertices[t[(k + 2) % 3]]) - at);
        sums[welded_[t[k]]] += angle * faces_[i];
        weights[welded_[t[k]]] += angle;
      }
    for (std::size_t i = 0; i < out.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const int vertex = welded_[mesh_.triangles[i][k]];
        out[i].normals[PseudoNormals::kCorners + k] = direction(sums[vertex], weights[vertex], faces_[i]);
      }
  }

  void setEdges(std::vector<PseudoNormals>& out) const {
    std::vector<EdgeUse> uses;
    uses.reserve(3 * out.size());
    for (std::size_t i = 0; i < out.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const Vec3i& t = mesh_.triangles[i];
        const auto [a, b] = std::minmax({welded_[t[k]], welded_[t[(k + 1) % 3]]});
        uses.push_back(
            {static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint64_t>(b), static_cast<int>(i), k});
      }
    std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
      return std::tie(a.ends, a.triangle, a.edge) < std::tie(b.ends, b.triangle, b.edge);
    });
    for (std::size_t first = 0, last = 0; first < uses.size(); first = last) {
      Vec3d sum;
      for (; last < uses.size() && uses[last].ends == uses[first].ends; ++last)
        sum += faces_[uses[last].triangle];
      for (std::size_t i = first; i < last; ++i)
        out[uses[i].triangle].normals[PseudoNormals::kEdges + uses[i].edge] =
            direction(sum, static_cast<double>(last - first), faces_[uses[i].triangle]);
    }
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<int> welded_;
  std::vector<Vec3d> faces_;
};

}  // namespace

std::vector<PseudoNormals> pseudoNormals(const TriangleMesh& mesh) {
  std::vector<PseudoNormals> out(mesh.triangles.size());
  const NormalSums sums(mesh);
  sums.setFaces(out);
  sums.setEdges(out);
  sums.setCorners(out);
  return out;
}

}  // namespace weir
