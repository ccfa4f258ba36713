// Small plain vectors, boxes and quaternions that live in kernels as well as on the host.
//
// They are aggregates without invariants, so arrays of them can be copied bytewise between devices.
// Host-only linear algebra (solves, decompositions, 4x4 matrices) uses Eigen instead.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "framework/base/api.h"
#include "framework/base/host_device.h"

namespace WEIR_API weir {

template <class T>
struct Vec2 {
  T x{}, y{};
  friend bool operator==(const Vec2&, const Vec2&) = default;
};

template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  WEIR_HD T& operator[](int i) { return i == 0 ? x : (i == 1 ? y : z); }
  WEIR_HD const T& operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }
  WEIR_HD Vec3& operator+=(const Vec3& b) { return *this = {T(x + b.x), T(y + b.y), T(z + b.z)}; }
  WEIR_HD Vec3& operator-=(const Vec3& b) { return *this = {T(x - b.x), T(y - b.y), T(z - b.z)}; }
  WEIR_HD Vec3& operator*=(T s) { return *this = {T(x * s), T(y * s), T(z * s)}; }

  friend WEIR_HD Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
  friend WEIR_HD Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
  friend WEIR_HD Vec3 operator-(const Vec3& a) { return {T(-a.x), T(-a.y), T(-a.z)}; }
  friend WEIR_HD Vec3 operator*(Vec3 a, T s) { return a *= s; }
  friend WEIR_HD Vec3 operator*(T s, Vec3 a) { return a *= s; }
  friend WEIR_HD Vec3 operator/(const Vec3& a, T s) { return {T(a.x / s), T(a.y / s), T(a.z / s)}; }
  friend WEIR_HD bool operator==(const Vec3& a, const Vec3& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
  }
};

template <class T>
struct Vec4 {
  T x{}, y{}, z{}, w{};
  friend bool operator==(const Vec4&, const Vec4&) = default;
};

using Vec2f = Vec2<float>;
using Vec2i = Vec2<int>;
using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;
using Vec3i = Vec3<int>;
using Vec4f = Vec4<float>;

template <class T>
WEIR_HD T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
WEIR_HD Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T>
WEIR_HD T length(const Vec3<T>& a) {
  return std::sqrt(dot(a, a));
}

/// The unit vector along a, or the zero vector for the zero vector.
template <class T>
WEIR_HD Vec3<T> normalized(const Vec3<T>& a) {
  const T l = length(a);
  return l > T(0) ? a / l : Vec3<T>{};
}

template <class T>
WEIR_HD Vec3<T> min(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}

template <class T>
WEIR_HD Vec3<T> max(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}

WEIR_HD inline bool isFinite(const Vec3f& a) {
  // One test for three numbers: a product with zero is NaN exactly when a factor is not finite.
  return a.x * 0.0f + a.y * 0.0f + a.z * 0.0f == 0.0f;
}

/// Axis-aligned box; the default one is empty.
struct Aabb {
  Vec3f lo{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
           std::numeric_limits<float>::infinity()};
  Vec3f hi{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
           -std::numeric_limits<float>::infinity()};

  WEIR_HD bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  WEIR_HD bool contains(const Vec3f& p) const {
    return p.x >= lo.x && p.y >= lo.y && p.z >= lo.z && p.x <= hi.x && p.y <= hi.y && p.z <= hi.z;
  }
  WEIR_HD void extend(const Vec3f& p) { lo = min(lo, p), hi = max(hi, p); }
  WEIR_HD void extend(const Aabb& b) { lo = min(lo, b.lo), hi = max(hi, b.hi); }
  WEIR_HD Vec3f center() const { return (lo + hi) * 0.5f; }
  WEIR_HD Vec3f size() const { return hi - lo; }
};

/// Unit quaternion w + xi + yj + zk.
struct Quatf {
  float w = 1, x = 0, y = 0, z = 0;
  friend bool operator==(const Quatf&, const Quatf&) = default;
};

WEIR_HD inline Vec3f rotate(const Quatf& q, const Vec3f& v) {
  const Vec3f u{q.x, q.y, q.z};
  const Vec3f t = 2.0f * cross(u, v);
  return v + q.w * t + cross(u, t);
}

WEIR_HD inline Quatf conjugate(const Quatf& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

/// Rotation by Euler angles in degrees, applied about the fixed x, then y, then z axis.
Quatf quaternionFromEulerDegrees(const Vec3f& degrees);

}  // namespace weir
