#include "framework/geometry/simplified_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace weir {

namespace {

constexpr int kMaxSpokes = 16;       // of a vertex that is merged, and of what it is merged into
constexpr double kSameWay = 0.96;    // cosine: a new triangle is turned like one of those it replaces
constexpr double kGoodShape = 0.05;  // height over longest edge; thinner only than what was there before
constexpr std::array<double, 4> kLevels{1.0 / 64, 1.0 / 16, 1.0 / 4,
                                        1};  // of the tolerance, one after another

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

/// A place seen along the axis.
struct Seen {
  double x = 0, y = 0, height = 0;
};

double turn(const Seen& a, const Seen& b, const Seen& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

struct Shape {
  Vec3d normal;     // unit vector; zero without area
  double slimness;  // height over longest edge
};

Shape shapeOf(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a, bc = c - b, ca = a - c, twice = cross(ab, c - a);
  const double area = std::sqrt(dot(twice, twice)),
               longest = std::max({dot(ab, ab), dot(bc, bc), dot(ca, ca)});
  return {area > 0 ? twice / area : Vec3d{}, longest > 0 ? area / longest : 0};
}

/// A vertex and the ring of its neighbours, counter-clockwise; place k of the arrays is ring vertex k.
struct Fan {
  int spokes = 0;
  std::array<int, kMaxSpokes> ring;
  std::array<Vec3d, kMaxSpokes> place;
  std::array<Seen, kMaxSpokes> seen;
  std::array<Shape, kMaxSpokes> shape;  // of the triangle between spoke k and the next
  Vec3d middle;                         // the vertex
  Seen seenMiddle;
  double slimmest = 1, error = 0;  // of its triangles

  int next(int k, int by = 1) const { return (k + by) % spokes; }
};

class Simplifier {
 public:
  Simplifier(const TriangleMesh& mesh, double tolerance)
      : tolerance_(tolerance), mesh_(mesh), errors_(mesh.triangles.size(), 0), around_(mesh.vertices.size()) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) around_[mesh.triangles[t][k]].push_back(static_cast<int>(t));
  }

  SimplifiedMesh run() {
    for (const double level : kLevels) mergeUpTo(level * tolerance_);
    return result();
  }

 private:
  bool isAlive(int triangle) const { return mesh_.triangles[triangle].x >= 0; }

  /// In sweeps, each of which leaves alone what has changed in it, so that merging stays even.
  void mergeUpTo(double allowed) {
    std::vector<int> pending;
    for (std::size_t u = 0; u < around_.size(); ++u)
      if (!around_[u].empty()) pending.push_back(static_cast<int>(u));
    std::vector<char> touched(around_.size(), 0);
    while (!pending.empty()) {
      std::vector<int> changed;
      for (const int u : pending) {
        if (touched[u] != 0 || !findFan(u)) continue;
        const int into = bestNeighbor(allowed);
        if (into < 0) continue;
        merge(u, into);
        for (int k = 0; k < fan_.spokes; ++k) {
          const int vertex = fan_.ring[k];
          if (std::exchange(touched[vertex], 1) == 0) changed.push_back(vertex);
        }
      }
      for (const int vertex : changed) touched[vertex] = 0;
      std::sort(changed.begin(), changed.end());
      pending = std::move(changed);
    }
  }

  /// False if the triangles around u are not a fan that covers a polygon once.
  bool findFan(int u) {
    const std::vector<int>& triangles = around_[u];
    const int count = static_cast<int>(triangles.size());
    if (count < 3 || count > kMaxSpokes) return false;
    std::array<std::pair<int, int>, kMaxSpokes> sides;
    fan_.error = 0;
    for (int k = 0; k < count; ++k) {
      const Vec3i& t = mesh_.triangles[triangles[k]];
      const int at = t.x == u ? 0 : (t.y == u ? 1 : 2);
      sides[k] = {t[(at + 1) % 3], t[(at + 2) % 3]};
      fan_.error = std::max(fan_.error, errors_[triangles[k]]);
    }
    for (int k = 1; k < count; ++k) {
      const auto after = std::find_if(sides.begin() + k, sides.begin() + count,
                                      [&](const auto& side) { return side.first == sides[k - 1].second; });
      if (after == sides.begin() + count) return false;
      std::swap(sides[k], *after);
    }
    if (sides[count - 1].second != sides[0].first) return false;
    fan_.spokes = count;
    for (int k = 0; k < count; ++k) fan_.ring[k] = sides[k].first;
    auto ring = fan_.ring;
    std::sort(ring.begin(), ring.begin() + count);
    if (std::adjacent_find(ring.begin(), ring.begin() + count) != ring.begin() + count) return false;
    return lookAlong(u);
  }

  /// Places the fan in the view along its ring's vector area.
  bool lookAlong(int u) {
    Fan& f = fan_;
    f.middle = toDouble(mesh_.vertices[u]);
    for (int k = 0; k < f.spokes; ++k) f.place[k] = toDouble(mesh_.vertices[f.ring[k]]);
    Vec3d axis;
    f.slimmest = 1;
    for (int k = 0; k < f.spokes; ++k) {
      const Vec3d &a = f.place[k], &b = f.place[f.next(k)];
      axis += cross(a - f.middle, b - f.middle);
      f.shape[k] = shapeOf(f.middle, a, b);
      f.slimmest = std::min(f.slimmest, f.shape[k].slimness);
    }
    const double size = std::sqrt(dot(axis, axis));
    if (!(size > 0)) return false;
    axis = axis / size;
    const Vec3d aside = std::abs(axis.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    Vec3d right = cross(aside, axis);
    right = right / std::sqrt(dot(right, right));
    const Vec3d up = cross(axis, right);
    for (int k = 0; k < f.spokes; ++k) {
      const Vec3d from = f.place[k] - f.middle;
      f.seen[k] = {dot(from, right), dot(from, up), dot(from, axis)};
    }
    f.seenMiddle = {};
    int rounds = 0;
    for (int k = 0; k < f.spokes; ++k) {
      const Seen &a = f.seen[k], &b = f.seen[f.next(k)];
      if (!(turn(f.seenMiddle, a, b) > 0)) return false;
      if (a.y < 0 && b.y >= 0) ++rounds;
    }
    return rounds == 1;
  }

  /// The place in the ring of the nearest neighbour that the vertex may be merged into, −1 for none.
  int bestNeighbor(double allowed) const {
    std::array<std::pair<double, int>, kMaxSpokes> order;
    for (int k = 0; k < fan_.spokes; ++k) {
      const Vec3d way = fan_.place[k] - fan_.middle;
      order[k] = {dot(way, way), k};
    }
    std::sort(order.begin(), order.begin() + fan_.spokes);
    for (int i = 0; i < fan_.spokes; ++i) {
      const int k = order[i].second;
      if (!isWellShaped(k) || !keepsTopology(k)) continue;
      const std::optional<double> apart = deviation(k);
      if (apart && fan_.error + *apart <= allowed) return k;
    }
    return -1;
  }

  bool isWellShaped(int into) const {
    const Fan& f = fan_;
    const double min = std::min(kGoodShape, f.slimmest);
    for (int by = 1; by + 1 < f.spokes; ++by) {
      const int a = f.next(into, by), b = f.next(into, by + 1);
      if (!(turn(f.seen[into], f.seen[a], f.seen[b]) > 0)) return false;
      const Shape shape = shapeOf(f.place[into], f.place[a], f.place[b]);
      if (!(shape.slimness >= min)) return false;
      const bool turned = std::none_of(f.shape.begin(), f.shape.begin() + f.spokes, [&](const Shape& old) {
        return dot(old.normal, shape.normal) >= kSameWay;
      });
      if (turned) return false;
    }
    return true;
  }

  bool areJoined(int a, int b) const {
    const bool swap = around_[a].size() > around_[b].size();
    const std::vector<int>& triangles = around_[swap ? b : a];
    return std::any_of(triangles.begin(), triangles.end(), [&](int triangle) {
      const Vec3i& t = mesh_.triangles[triangle];
      const int other = swap ? a : b;
      return t.x == other || t.y == other || t.z == other;
    });
  }

  /// The new edges must not be there yet, nor the only triangle that is left of a fan of three.
  bool keepsTopology(int into) const {
    const Fan& f = fan_;
    const std::size_t had = around_[f.ring[into]].size(), gains = static_cast<std::size_t>(f.spokes) - 4;
    if (f.spokes > 4 && had + gains > kMaxSpokes) return false;
    if (f.spokes == 3) {
      const std::vector<int>& triangles = around_[f.ring[into]];
      const int a = f.ring[f.next(into)], b = f.ring[f.next(into, 2)];
      return std::none_of(triangles.begin(), triangles.end(), [&](int triangle) {
        const Vec3i& t = mesh_.triangles[triangle];
        return (t.x == a || t.y == a || t.z == a) && (t.x == b || t.y == b || t.z == b);
      });
    }
    for (int by = 2; by + 1 < f.spokes; ++by)
      if (areJoined(f.ring[into], f.ring[f.next(into, by)])) return false;
    return true;
  }

  /// The greatest difference of heights between the two fans.
  std::optional<double> deviation(int into) const {
    std::optional<double> max = heightOfMiddle(into);
    if (!max) return {};
    const Fan& f = fan_;
    for (int by = 2; by + 1 < f.spokes; ++by) {
      const Seen &from = f.seen[into], &to = f.seen[f.next(into, by)];
      for (int k = 0; k < f.spokes; ++k) {
        // Where the spoke to place k meets the new one; the vertex itself is the origin.
        const Seen& end = f.seen[k];
        const double one = turn(from, to, f.seenMiddle), other = turn(from, to, end);
        if (!(one * other < 0)) continue;
        const double outward = one / (one - other);
        const Seen at{outward * end.x, outward * end.y, outward * end.height};
        const double dx = to.x - from.x, dy = to.y - from.y;
        const double along = ((at.x - from.x) * dx + (at.y - from.y) * dy) / (dx * dx + dy * dy);
        if (!(along >= 0 && along <= 1)) continue;
        const double height = from.height + along * (to.height - from.height);
        max = std::max(*max, std::abs(height - at.height));
      }
    }
    return max;
  }

  /// How far the vertex is above or below the new fan; nothing if rounding hides where.
  std::optional<double> heightOfMiddle(int into) const {
    const Fan& f = fan_;
    for (int by = 1; by + 1 < f.spokes; ++by) {
      const Seen &a = f.seen[into], &b = f.seen[f.next(into, by)], &c = f.seen[f.next(into, by + 1)];
      const double toA = turn(b, c, f.seenMiddle), toB = turn(c, a, f.seenMiddle),
                   toC = turn(a, b, f.seenMiddle);
      if (toA < 0 || toB < 0 || toC < 0) continue;
      return std::abs(toA * a.height + toB * b.height + toC * c.height) / (toA + toB + toC);
    }
    return {};
  }

  void merge(int u, int into) {
    const int v = fan_.ring[into];
    const double error = fan_.error + *deviation(into);
    for (const int triangle : std::exchange(around_[u], {})) {
      Vec3i& t = mesh_.triangles[triangle];
      if (t.x == v || t.y == v || t.z == v) {
        for (int k = 0; k < 3; ++k)
          if (t[k] != u) std::erase(around_[t[k]], triangle);
        t = {-1, -1, -1};
        continue;
      }
      for (int k = 0; k < 3; ++k)
        if (t[k] == u) t[k] = v;
      errors_[triangle] = error;
      around_[v].push_back(triangle);
    }
  }

  SimplifiedMesh result() const {
    SimplifiedMesh found;
    std::vector<int> renamed(mesh_.vertices.size(), -1);
    for (std::size_t v = 0; v < around_.size(); ++v) {
      if (around_[v].empty()) continue;
      renamed[v] = static_cast<int>(found.mesh.vertices.size());
      found.mesh.vertices.push_back(mesh_.vertices[v]);
    }
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (!isAlive(static_cast<int>(t))) continue;
      const Vec3i& of = mesh_.triangles[t];
      found.mesh.triangles.push_back({renamed[of.x], renamed[of.y], renamed[of.z]});
      found.deviation = std::max(found.deviation, errors_[t]);
    }
    return found;
  }

  double tolerance_;
  TriangleMesh mesh_;                     // triangles that are gone have the vertices −1
  std::vector<double> errors_;            // of the triangles, m
  std::vector<std::vector<int>> around_;  // the triangles of each vertex
  Fan fan_;
};

}  // namespace

SimplifiedMesh simplified(const TriangleMesh& mesh, double tolerance) {
  if (!(tolerance > 0)) return {mesh, 0};
  return Simplifier(mesh, tolerance).run();
}

}  // namespace weir
