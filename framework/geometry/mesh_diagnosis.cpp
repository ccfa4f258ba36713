// What is wrong with a mesh: one pass over its edges, sorted so that those of neighbours stand together.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "framework/geometry/triangle_mesh.h"

namespace weir {

namespace {

struct EdgeUse {
  int low, high;  // its vertices
  int triangle;
  bool forward;  // whether the triangle goes from low to high
};

std::vector<EdgeUse> sortedEdges(const TriangleMesh& mesh) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles[i][k], b = mesh.triangles[i][(k + 1) % 3];
      if (a != b) uses.push_back({std::min(a, b), std::max(a, b), static_cast<int>(i), a < b});
    }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return uses;
}

/// Triangles joined to patches by edges of two, each known to be turned as its patch's root is, or the other
/// way.
class Patches {
 public:
  explicit Patches(std::size_t triangles) : parents_(triangles), turned_(triangles) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  void join(int a, int b, bool turnedAlike) {
    const auto [rootA, turnA] = find(a);
    const auto [rootB, turnB] = find(b);
    if (rootA == rootB)
      return;  // a patch that contradicts itself, such as a Möbius strip, keeps what came first
    parents_[rootB] = rootA;
    turned_[rootB] = turnA ^ turnB ^ !turnedAlike;
  }

  /// The fewest triangles that must be turned so that each patch is of one mind.
  std::int64_t fewestToTurn() {
    std::vector<std::array<std::int64_t, 2>> counts(parents_.size());
    for (std::size_t i = 0; i < parents_.size(); ++i) {
      const auto [root, turn] = find(static_cast<int>(i));
      ++counts[root][turn];
    }
    std::int64_t sum = 0;
    for (const auto& [as, against] : counts) sum += std::min(as, against);
    return sum;
  }

 private:
  std::pair<int, bool> find(int triangle) {
    int root = triangle;
    bool turn = false;
    for (; parents_[root] != root; root = parents_[root]) turn ^= turned_[root];
    // Shortens the way for the next time.
    for (bool left = turn; parents_[triangle] != triangle;) {
      const int next = parents_[triangle];
      const bool step = turned_[triangle];
      parents_[triangle] = root, turned_[triangle] = left;
      triangle = next, left ^= step;
    }
    return {root, turn};
  }

  std::vector<int> parents_;
  std::vector<char> turned_;  // against the parent
};

/// Duplicates have the same three vertices, in any order.
std::int64_t countDuplicates(const TriangleMesh& mesh) {
  std::vector<std::array<int, 3>> keys;
  keys.reserve(mesh.triangles.size());
  for (const Vec3i& t : mesh.triangles) {
    std::array<int, 3> key{t.x, t.y, t.z};
    std::sort(key.begin(), key.end());
    keys.push_back(key);
  }
  std::sort(keys.begin(), keys.end());
  return keys.end() - std::unique(keys.begin(), keys.end());
}

std::int64_t countDegenerate(const TriangleMesh& mesh) {
  return std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Vec3i& t) {
    const Vec3f normal =
        cross(mesh.vertices[t.y] - mesh.vertices[t.x], mesh.vertices[t.z] - mesh.vertices[t.x]);
    return t.x == t.y || t.y == t.z || t.z == t.x || length(normal) == 0;
  });
}

}  // namespace

MeshDiagnosis diagnose(const TriangleMesh& mesh) {
  MeshDiagnosis d;
  for (const Vec3f& v : mesh.vertices) d.nonFiniteVertices += isFinite(v) ? 0 : 1;
  d.degenerateTriangles = countDegenerate(mesh);
  d.duplicateTriangles = countDuplicates(mesh);
  const std::vector<EdgeUse> uses = sortedEdges(mesh);
  Patches patches(mesh.triangles.size());
  for (std::size_t first = 0, last = 0; first < uses.size(); first = last) {
    const EdgeUse& edge = uses[first];
    while (last < uses.size() && uses[last].low == edge.low && uses[last].high == edge.high) ++last;
    d.openEdges += last - first == 1;
    d.nonManifoldEdges += last - first > 2;
    if (last - first != 2) continue;
    const bool consistent = edge.forward != uses[first + 1].forward;
    d.inconsistentEdges += !consistent;
    patches.join(edge.triangle, uses[first + 1].triangle, consistent);
  }
  d.flippedTriangles = patches.fewestToTurn();
  d.insideOut = mesh.volume() < 0;
  return d;
}

std::string MeshDiagnosis::message() const {
  std::string text;
  const auto add = [&](std::int64_t count, const char* what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
  };
  add(openEdges, "open edges (holes)");
  add(nonManifoldEdges, "edges of more than two triangles");
  add(inconsistentEdges, "edges between triangles that are turned differently");
  add(flippedTriangles, "triangles turned against most of their neighbours");
  add(degenerateTriangles, "triangles without area");
  add(duplicateTriangles, "duplicate triangles");
  add(nonFiniteVertices, "vertices that are NaN or infinite");
  if (insideOut) text += std::string(text.empty() ? "" : ", ") + "inside out";
  return text;
}

}  // namespace weir
