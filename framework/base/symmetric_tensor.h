// A symmetric matrix, by its two parts.
#pragma once

#include "framework/base/host_device.h"
#include "framework/base/vec.h"

namespace weir {

template <class T>
struct SymmetricTensorOf {
  Vec3<T> diagonal{}, off{};  ///< xx, yy, zz; xy, xz, yz

  WEIR_HD Vec3<T> operator*(const Vec3<T>& r) const {
    return {diagonal.x * r.x + off.x * r.y + off.y * r.z, off.x * r.x + diagonal.y * r.y + off.z * r.z,
            off.y * r.x + off.z * r.y + diagonal.z * r.z};
  }
  WEIR_HD SymmetricTensorOf& operator+=(const SymmetricTensorOf& other) {
    diagonal += other.diagonal;
    off += other.off;
    return *this;
  }
  /// Adds weight·r⊗r.
  WEIR_HD void addSquare(T weight, const Vec3<T>& r) {
    diagonal += weight * Vec3<T>{r.x * r.x, r.y * r.y, r.z * r.z};
    off += weight * Vec3<T>{r.x * r.y, r.x * r.z, r.y * r.z};
  }
  WEIR_HD T determinant() const {
    const Vec3<T> d = diagonal, o = off;
    return d.x * (d.y * d.z - o.z * o.z) - o.x * (o.x * d.z - o.z * o.y) + o.y * (o.x * o.z - d.y * o.y);
  }
};
using SymmetricTensor = SymmetricTensorOf<float>;

}  // namespace weir
