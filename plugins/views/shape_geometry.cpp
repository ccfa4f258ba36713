#include "plugins/views/shape_geometry.h"

#include <array>
#include <cmath>
#include <numbers>

#include "framework/geometry/surface_of_revolution.h"
#include "plugins/views/camera_axes.h"

namespace weir::rendering {

namespace {

constexpr int kSegments = 64;
constexpr float kPi = std::numbers::pi_v<float>;

TriangleMesh boxMesh(const Vec3f& h) {
  const std::array<Vec3f, 8> corners = cornersOf({-h, h});
  TriangleMesh mesh{{corners.begin(), corners.end()}, {}};
  // Each side by its corners, counter-clockwise seen from outside.
  constexpr int kSides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& s : kSides) {
    mesh.triangles.push_back({s[0], s[1], s[2]});
    mesh.triangles.push_back({s[0], s[2], s[3]});
  }
  return mesh;
}

/// [radius, height] from the lower to the upper end of the axis.
std::vector<Vec2f> profileOf(const Shape& s) {
  std::vector<Vec2f> profile;
  const auto arc = [&](float from, float to, float centerHeight) {
    for (int k = 0; k <= kSegments / 2; ++k) {
      const float a = from + (to - from) * float(k) / float(kSegments / 2);
      profile.push_back({std::max(0.0f, s.radius * std::cos(a)), centerHeight + s.radius * std::sin(a)});
    }
  };
  switch (s.kind) {
    case ShapeKind::kSphere:
      arc(-kPi / 2, kPi / 2, 0);
      break;
    case ShapeKind::kCylinder:
      profile = {{0, -s.height / 2}, {s.radius, -s.height / 2}, {s.radius, s.height / 2}, {0, s.height / 2}};
      break;
    case ShapeKind::kCapsule:
      arc(-kPi / 2, 0, -s.height / 2);
      arc(0, kPi / 2, s.height / 2);
      break;
    case ShapeKind::kCone:
      profile = {{0, 0}, {s.radius, 0}, {0, s.height}};
      break;
    case ShapeKind::kBox:
    case ShapeKind::kPlane:
      break;
  }
  return profile;
}

/// A circle of a radius around the y axis.
void addCircle(std::vector<Line>& lines, float radius, float height) {
  const auto at = [&](int k) {
    const float a = 2 * kPi * float(k) / kSegments;
    return Vec3f{radius * std::cos(a), height, radius * std::sin(a)};
  };
  for (int k = 0; k < kSegments; ++k) lines.push_back({at(k), at(k + 1)});
}

/// The profile in the two planes through the axis.
void addProfile(std::vector<Line>& lines, const std::vector<Vec2f>& profile) {
  for (std::size_t k = 0; k + 1 < profile.size(); ++k)
    for (const float side : {-1.0f, 1.0f}) {
      const Vec2f a = profile[k], b = profile[k + 1];
      lines.push_back({{side * a.x, a.y, 0}, {side * b.x, b.y, 0}});
      lines.push_back({{0, a.y, side * a.x}, {0, b.y, side * b.x}});
    }
}

void addBox(std::vector<Line>& lines, const Vec3f& h) {
  const std::array<Vec3f, 8> corners = cornersOf({-h, h});
  for (std::size_t k = 0; k < corners.size(); ++k)
    for (const std::size_t axis : {1u, 2u, 4u})
      if ((k & axis) == 0) lines.push_back({corners[k], corners[k | axis]});
}

}  // namespace

TriangleMesh meshOfShape(const Shape& shape) {
  if (shape.kind == ShapeKind::kPlane) return {};
  TriangleMesh mesh = shape.kind == ShapeKind::kBox
                          ? boxMesh(shape.halfSize)
                          : surfaceOfRevolution(revolutionOutline(profileOf(shape), {}), kSegments);
  mesh.transform(1, shape.rotation, shape.position);
  return mesh;
}

std::vector<Line> outlineOfShape(const Shape& shape) {
  std::vector<Line> lines;
  const float half = shape.height / 2;
  switch (shape.kind) {
    case ShapeKind::kBox:
      addBox(lines, shape.halfSize);
      break;
    case ShapeKind::kSphere:
      addCircle(lines, shape.radius, 0);
      break;
    case ShapeKind::kCylinder:
    case ShapeKind::kCapsule:
      addCircle(lines, shape.radius, -half);
      addCircle(lines, shape.radius, half);
      break;
    case ShapeKind::kCone:
      addCircle(lines, shape.radius, 0);
      break;
    case ShapeKind::kPlane:
      break;
  }
  addProfile(lines, profileOf(shape));
  for (Line& line : lines) {
    line.from = rotate(shape.rotation, line.from) + shape.position;
    line.to = rotate(shape.rotation, line.to) + shape.position;
  }
  return lines;
}

}  // namespace weir::rendering
