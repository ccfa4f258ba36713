#include "framework/geometry/mass_properties.h"

namespace weir {

namespace {

Vec3d fromOrigin(const Vec3f& p, const Vec3d& origin) {
  return Vec3d{p.x, p.y, p.z} - origin;
}

/// Adds w·r·rᵀ.
void addSquare(Symmetric3& to, double w, const Vec3d& r) {
  to.xx += w * r.x * r.x, to.yy += w * r.y * r.y, to.zz += w * r.z * r.z;
  to.xy += w * r.x * r.y, to.yz += w * r.y * r.z, to.zx += w * r.z * r.x;
}

}  // namespace

MassProperties massProperties(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return {};
  const Vec3f amid = mesh.bounds().center();
  const Vec3d origin{amid.x, amid.y, amid.z};
  double volume = 0;
  Vec3d first;         // ∫ r dV
  Symmetric3 squares;  // ∫ r·rᵀ dV
  for (const Vec3i& t : mesh.triangles) {
    const Vec3d a = fromOrigin(mesh.vertices[std::size_t(t.x)], origin);
    const Vec3d b = fromOrigin(mesh.vertices[std::size_t(t.y)], origin);
    const Vec3d c = fromOrigin(mesh.vertices[std::size_t(t.z)], origin);
    const double det = dot(a, cross(b, c));
    volume += det / 6;
    first += (det / 24) * (a + b + c);
    for (const Vec3d& r : {a, b, c, a + b + c}) addSquare(squares, det / 120, r);
  }
  if (volume == 0) return {};
  const Vec3d center = first / volume;
  addSquare(squares, -volume, center);
  return {.volume = volume,
          .center = origin + center,
          .inertia = {.xx = squares.yy + squares.zz,
                      .yy = squares.zz + squares.xx,
                      .zz = squares.xx + squares.yy,
                      .xy = -squares.xy,
                      .yz = -squares.yz,
                      .zx = -squares.zx}};
}

}  // namespace weir
