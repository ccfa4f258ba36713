// Eigenvalues and eigenvectors of a symmetric 3x3 matrix in closed form, for kernels.
//
// The eigenvalues are the roots of the characteristic polynomial as cosines: with q = tr A/3,
// p² = tr (A − q)²/6 and r = det((A − q)/p)/2 they are q + 2p·cos(acos(r)/3 + 2πk/3). One of the two outer
// ones is always well apart from the others: for r >= 0 the largest, otherwise the smallest. Its
// eigenvector is a cross product of rows of A − λ; that of the middle one follows in the plane that is left,
// and the third is perpendicular to both. So vectors are orthonormal whatever the eigenvalues are.
#pragma once

#include <cmath>

#include "framework/base/vec.h"

namespace weir {

struct SymmetricMatrix {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  WEIR_HD Vec3d operator*(const Vec3d& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
  WEIR_HD double determinant() const {
    return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  }
  /// Adds s·v·vᵀ.
  WEIR_HD void addProduct(double s, const Vec3d& v) {
    xx += s * v.x * v.x, yy += s * v.y * v.y, zz += s * v.z * v.z;
    xy += s * v.x * v.y, xz += s * v.x * v.z, yz += s * v.y * v.z;
  }
};

struct SymmetricEigen {
  Vec3d values;     ///< the largest first
  Vec3d vectors[3]; /**< of length 1, perpendicular to each other, in the order of the values */
};

namespace detail {

/// A unit vector v with (A − λ)·v = 0, for an eigenvalue that is apart from the others.
WEIR_HD inline Vec3d eigenvectorOf(const SymmetricMatrix& a, double value) {
  const Vec3d rows[3] = {{a.xx - value, a.xy, a.xz}, {a.xy, a.yy - value, a.yz}, {a.xz, a.yz, a.zz - value}};
  Vec3d best{};
  double bestSquare = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3d candidate = cross(rows[k], rows[(k + 1) % 3]);
    const double square = dot(candidate, candidate);
    if (square > bestSquare) best = candidate, bestSquare = square;
  }
  return bestSquare > 0 ? best / std::sqrt(bestSquare) : Vec3d{1, 0, 0};
}

WEIR_HD inline Vec3d perpendicularTo(const Vec3d& unit) {
  const Vec3d aside = fabs(unit.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  return normalized(cross(unit, aside));
}

/// The eigenvector of `value` in the plane perpendicular to the eigenvector `first`.
WEIR_HD inline Vec3d orthogonalEigenvector(const SymmetricMatrix& a, const Vec3d& first, double value) {
  const Vec3d u = perpendicularTo(first), v = cross(first, u);
  const Vec3d au = a * u, av = a * v;
  const double uu = dot(u, au) - value, uv = dot(u, av), vv = dot(v, av) - value;
  // The longer row of the 2x2 matrix tells the direction better; none if all directions are eigenvectors.
  const bool upper = uu * uu + uv * uv >= uv * uv + vv * vv;
  const double x = upper ? -uv : -vv, y = upper ? uu : uv;
  const double size = std::sqrt(x * x + y * y);
  return size > 0 ? (x / size) * u + (y / size) * v : u;
}

}  // namespace detail

/// The matrix must be finite. Values are right to about 1e-8 of the largest, relative.
WEIR_HD inline SymmetricEigen eigenOf(const SymmetricMatrix& a) {
  const double mean = (a.xx + a.yy + a.zz) / 3;
  const double x = a.xx - mean, y = a.yy - mean, z = a.zz - mean;
  const double off = a.xy * a.xy + a.xz * a.xz + a.yz * a.yz;
  const double p = std::sqrt((x * x + y * y + z * z + 2 * off) / 6);
  SymmetricEigen result{{mean, mean, mean}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  if (!(p > 1e-12 * fabs(mean))) return result;  // a multiple of the identity
  const SymmetricMatrix b{x / p, y / p, z / p, a.xy / p, a.xz / p, a.yz / p};
  const double r = b.determinant() / 2, bounded = r < -1 ? -1 : (r > 1 ? 1 : r);
  constexpr double kThirdTurn = 2.0943951023931953;
  const double angle = acos(bounded) / 3;
  const double largest = mean + 2 * p * cos(angle), smallest = mean + 2 * p * cos(angle + kThirdTurn);
  const double middle = 3 * mean - largest - smallest;
  result.values = {largest, middle, smallest};
  const bool fromLargest = r >= 0;
  const Vec3d first = detail::eigenvectorOf(a, fromLargest ? largest : smallest);
  const Vec3d second = detail::orthogonalEigenvector(a, first, middle);
  result.vectors[0] = fromLargest ? first : cross(first, second);
  result.vectors[1] = second;
  result.vectors[2] = fromLargest ? cross(first, second) : first;
  return result;
}

}  // namespace weir
