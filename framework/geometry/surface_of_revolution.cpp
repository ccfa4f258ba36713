#include "framework/geometry/surface_of_revolution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/base/check.h"
#include "framework/base/error.h"

namespace weir {

namespace {

using Point = Outline::Point;

Point operator+(const Point& a, const Point& b) {
  return {a.radius + b.radius, a.height + b.height};
}
Point operator-(const Point& a, const Point& b) {
  return {a.radius - b.radius, a.height - b.height};
}
Point operator*(double s, const Point& a) {
  return {s * a.radius, s * a.height};
}
bool operator==(const Point& a, const Point& b) {
  return a.radius == b.radius && a.height == b.height;
}

double dot(const Point& a, const Point& b) {
  return a.radius * b.radius + a.height * b.height;
}
/// Positive if b is to the left of a.
double cross(const Point& a, const Point& b) {
  return a.radius * b.height - a.height * b.radius;
}
Point unit(const Point& a) {
  return 1 / std::sqrt(dot(a, a)) * a;
}
Point leftOf(const Point& direction) {
  return {-direction.height, direction.radius};
}

std::string text(const Point& p) {
  return fmt::format("[{:.6g}, {:.6g}]", p.radius, p.height);
}

/// Twice the area on the left of the outline, which is closed by a straight line.
double doubleArea(const std::vector<Point>& points) {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    sum += cross(points[i] - points[0], points[(i + 1) % points.size()] - points[0]);
  return sum;
}

/// The profile's points, without repetitions, and with those near the axis on it.
std::vector<Point> checkedPoints(const std::vector<Vec2f>& profile) {
  constexpr std::size_t kMaxPoints = 10000;  // all pairs of lines are tested
  if (profile.size() > kMaxPoints)
    throw sceneError(fmt::format("the profile has {} points", profile.size()),
                     fmt::format("at most {}", kMaxPoints));
  double size = 0;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const Vec2f& p = profile[i];
    if (!std::isfinite(p.x) || !std::isfinite(p.y))
      throw sceneError(fmt::format("point {} of the profile is not finite", i), "finite numbers");
    if (p.x < 0)
      throw sceneError(fmt::format("point {} of the profile, [{}, {}], has a negative radius", i, p.x, p.y),
                       "[radius, height] with a radius of at least 0");
    size = std::max({size, double(p.x), std::abs(double(p.y) - profile[0].y)});
  }
  constexpr double kOnAxis = 1e-6;
  std::vector<Point> points;
  for (const Vec2f& p : profile) {
    const Point point{p.x <= kOnAxis * size ? 0.0 : p.x, p.y};
    if (points.empty() || !(points.back() == point)) points.push_back(point);
  }
  if (points.size() < 2)
    throw sceneError(fmt::format("the profile has {} different points", points.size()), "at least 2");
  if (std::all_of(points.begin(), points.end(), [](const Point& p) { return p.radius == 0; }))
    throw sceneError("all points of the profile are on the axis", "a point with a radius above 0");
  for (std::size_t i = 1; i + 1 < points.size(); ++i)
    if (points[i].radius == 0)
      throw sceneError(fmt::format("the profile touches the axis at {}, between its ends", text(points[i])),
                       "a radius above 0 at all points but the first and the last");
  return points;
}

/// Whether two segments meet, touching included.
bool segmentsMeet(const Point& a, const Point& b, const Point& c, const Point& d) {
  if (std::max(a.radius, b.radius) < std::min(c.radius, d.radius) ||
      std::max(c.radius, d.radius) < std::min(a.radius, b.radius) ||
      std::max(a.height, b.height) < std::min(c.height, d.height) ||
      std::max(c.height, d.height) < std::min(a.height, b.height))
    return false;
  const double cLeft = cross(b - a, c - a), dLeft = cross(b - a, d - a);
  const double aLeft = cross(d - c, a - c), bLeft = cross(d - c, b - c);
  return cLeft * dLeft <= 0 && aLeft * bLeft <= 0;
}

/// Whether b → c lies back on a → b.
bool turnsBack(const Point& a, const Point& b, const Point& c) {
  constexpr double kSameDirection = 1e-9;  // sine of the angle between them
  const Point in = b - a, out = c - b;
  return dot(in, out) < 0 && std::abs(cross(in, out)) <= kSameDirection * -dot(in, out);
}

void checkSimple(const Outline& outline, const std::string& hint) {
  const std::vector<Point>& p = outline.points;
  const std::size_t n = p.size(), edges = outline.closed ? n : n - 1;
  const auto refuse = [&](std::size_t i, std::size_t j) {
    throw sceneError(fmt::format("the line from {} to {} meets the line from {} to {}", text(p[i]),
                                 text(p[(i + 1) % n]), text(p[j]), text(p[(j + 1) % n])),
                     "a profile that neither crosses nor touches itself", hint);
  };
  for (std::size_t i = 0; i < edges; ++i) {
    const std::size_t next = (i + 1) % n;
    if ((next < edges) && turnsBack(p[i], p[next], p[(i + 2) % n])) refuse(i, next);
    for (std::size_t j = i + 2; j < edges; ++j)
      if ((j + 1) % n != i && segmentsMeet(p[i], p[next], p[j], p[(j + 1) % n])) refuse(i, j);
  }
}

/// The points of the parallel at `thickness` to the left of a corner between two directions: one where the
/// mitre is short, two where the corner is cut off square at the distance of the thickness.
std::vector<Point> joint(const Point& corner, const Point& in, const Point& out, double thickness) {
  constexpr double kLongestMitre = 2;  // times the thickness
  const Point a = leftOf(in), b = leftOf(out);
  const double cosine = dot(a, b);
  const double halfCosine = std::sqrt(std::max(0.0, 0.5 * (1 + cosine)));
  const bool opens = cross(in, out) < 0;  // the parallel is on the outer side of the corner
  if (!opens || halfCosine * kLongestMitre >= 1)
    return {corner + thickness / std::max(1 + cosine, 1e-12) * (a + b)};
  const double halfSine = std::sqrt(0.5 * (1 - cosine));
  const double beyond = thickness * (1 - halfCosine) / halfSine;
  return {corner + thickness * a + beyond * in, corner + thickness * b - beyond * out};
}

/// The parallel of an open profile at `thickness` on its left.
std::vector<Point> parallel(const std::vector<Point>& p, double thickness) {
  const std::size_t last = p.size() - 1;
  std::vector<Point> directions;
  for (std::size_t i = 0; i < last; ++i) directions.push_back(unit(p[i + 1] - p[i]));
  // On the axis, the profile meets its mirror image.
  const auto mirrored = [](const Point& d) { return Point{-d.radius, d.height}; };
  const Point before = p.front().radius == 0 ? -1.0 * mirrored(directions.front()) : directions.front();
  const Point after = p.back().radius == 0 ? -1.0 * mirrored(directions.back()) : directions.back();

  std::vector<Point> result;
  std::vector<std::size_t> lastOfJoint;
  for (std::size_t i = 0; i <= last; ++i) {
    const Point& in = i == 0 ? before : directions[i - 1];
    const Point& out = i == last ? after : directions[i];
    std::vector<Point> points = joint(p[i], in, out, thickness);
    if (p[i].radius == 0) {
      // Half of the joint is the mirror image of the other half; in the middle is the axis.
      const Point& own = i == 0 ? points.back() : points.front();
      const Point middle{0, own.height};
      if (points.size() == 1)
        points = {middle};
      else
        points = i == 0 ? std::vector{middle, own} : std::vector{own, middle};
    }
    if (i > 0 && dot(points.front() - result.back(), directions[i - 1]) <= 0)
      throw sceneError(
          fmt::format("a wall of {:.6g} m does not fit behind the line from {} to {}, where the profile is "
                      "bent too tightly",
                      thickness, text(p[i - 1]), text(p[i])),
          "a thickness below the radius of the bend", "make the wall thinner or the bend wider");
    constexpr double kClear = 1e-6;  // of the thickness; closer to the axis is a touch
    for (const Point& point : points)
      if (p[i].radius > 0 && point.radius <= kClear * thickness)
        throw sceneError(
            fmt::format("a wall of {:.6g} m reaches across the axis at {}", thickness, text(p[i])),
            "a thickness below the radius");
    result.insert(result.end(), points.begin(), points.end());
  }
  return result;
}

/// The profile with lines to the axis at those ends that are not on it.
std::vector<Point> withCaps(const std::vector<Point>& points) {
  std::vector<Point> capped;
  if (points.front().radius > 0) capped.push_back({0, points.front().height});
  capped.insert(capped.end(), points.begin(), points.end());
  if (points.back().radius > 0) capped.push_back({0, points.back().height});
  return capped;
}

Outline wallOutline(std::vector<Point> points, bool flat, double thickness) {
  if (!(thickness > 0) || !std::isfinite(thickness))
    throw sceneError(fmt::format("the thickness is {}", thickness), "a number above 0");
  checkSimple({points, false}, {});
  std::vector<Point> inner = parallel(points, thickness);
  Outline outline{std::move(points), true};
  outline.points.insert(outline.points.end(), inner.rbegin(), inner.rend());
  checkSimple(outline, fmt::format("the wall of {:.6g} m runs into another part of itself there", thickness));
  WEIR_CHECK((flat || doubleArea(outline.points) > 0));
  return outline;
}

}  // namespace

Outline revolutionOutline(const std::vector<Vec2f>& profile, const RevolutionOptions& options) {
  std::vector<Point> points = checkedPoints(profile);
  const bool ring = points.front() == points.back();
  if (ring) points.pop_back();
  if (ring && points.front().radius == 0)
    throw sceneError("the profile starts and ends at the same point of the axis",
                     "different ends, or a closed profile that does not touch the axis");
  std::vector<Point> whole = ring ? points : withCaps(points);
  // An area below this share of the profile's square extent is rounding.
  constexpr double kFlat = 1e-12;
  double squareExtent = 0;
  for (const Point& p : whole) squareExtent = std::max(squareExtent, dot(p - whole[0], p - whole[0]));
  const double area = doubleArea(whole);
  const bool flat = std::abs(area) <= kFlat * squareExtent;
  if (!flat && area < 0) {
    std::reverse(points.begin(), points.end());
    std::reverse(whole.begin(), whole.end());
  }
  if (options.thickness) {
    if (ring)
      throw sceneError("a thickness is given for a closed profile, which is a wall already",
                       "no thickness, or an open profile");
    return wallOutline(std::move(points), flat, *options.thickness);
  }
  if (!ring && !options.caps) {
    checkSimple({points, false}, {});
    return {points, false};
  }
  if (flat) throw sceneError("the profile encloses no volume", "a profile with an inside, or a thickness");
  checkSimple({whole, true},
              ring ? "" : "an end that is not on the axis is closed by a disc, which may be what is met");
  return {whole, true};
}

TriangleMesh surfaceOfRevolution(const Outline& outline, int segments) {
  WEIR_CHECK(segments >= 3);
  TriangleMesh mesh;
  std::vector<int> first;  // the first vertex of each point
  for (const Point& p : outline.points) {
    first.push_back(static_cast<int>(mesh.vertices.size()));
    const int count = p.radius == 0 ? 1 : segments;
    for (int k = 0; k < count; ++k) {
      const double angle = 2 * std::numbers::pi * k / segments;
      mesh.vertices.push_back({static_cast<float>(p.radius * std::cos(angle)), static_cast<float>(p.height),
                               static_cast<float>(-p.radius * std::sin(angle))});
    }
  }
  const auto vertex = [&](std::size_t i, int k) {
    return outline.points[i].radius == 0 ? first[i] : first[i] + k % segments;
  };
  const std::size_t n = outline.points.size(), edges = outline.closed ? n : n - 1;
  for (std::size_t i = 0; i < edges; ++i) {
    const std::size_t j = (i + 1) % n;
    const bool fromAxis = outline.points[i].radius == 0, toAxis = outline.points[j].radius == 0;
    for (int k = 0; k < segments; ++k) {
      if (!fromAxis) mesh.triangles.push_back({vertex(i, k), vertex(i, k + 1), vertex(j, k)});
      if (!toAxis) mesh.triangles.push_back({vertex(i, k + 1), vertex(j, k + 1), vertex(j, k)});
    }
  }
  return mesh;
}

}  // namespace weir
