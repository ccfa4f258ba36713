// A small plain 3x3 matrix that lives in kernels as well as on the host.
#pragma once

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

/// Rows of numbers. An aggregate without invariants, like the vectors.
template <class T>
struct Mat3 {
  Vec3<T> rows[3];

  WEIR_HD Vec3<T>& operator[](int row) { return rows[row]; }
  WEIR_HD const Vec3<T>& operator[](int row) const { return rows[row]; }
  friend WEIR_HD bool operator==(const Mat3& a, const Mat3& b) {
    return a.rows[0] == b.rows[0] && a.rows[1] == b.rows[1] && a.rows[2] == b.rows[2];
  }
};

using Mat3f = Mat3<float>;

template <class T>
WEIR_HD Vec3<T> operator*(const Mat3<T>& a, const Vec3<T>& v) {
  return {dot(a[0], v), dot(a[1], v), dot(a[2], v)};
}

/// The root of the sum of the squares of all numbers.
template <class T>
WEIR_HD T frobeniusNorm(const Mat3<T>& a) {
  return std::sqrt(dot(a[0], a[0]) + dot(a[1], a[1]) + dot(a[2], a[2]));
}

}  // namespace weir
