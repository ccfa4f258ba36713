// Eight numbers at a time, for the inner loops of kernels on the CPU.
//
// Lanes is to be used like a float: a lambda that takes `auto` works on one neighbour as well as on eight.
// There are eight lanes on every processor, in registers of whatever width it has, so sums are added up in
// the same order everywhere. Made of the vector extensions of GCC and Clang; WEIR_HAS_LANES says whether they
// are there. Kernels of CUDA know only the overloads for one number.
#pragma once

#include <cmath>
#include <cstdint>

#include "framework/base/api.h"
#include "framework/base/sanitizers.h"
#include "framework/base/vec.h"

#if defined(__GNUC__) && !defined(__CUDACC__) && defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define WEIR_HAS_LANES
#endif
#endif

#if defined(WEIR_HAS_LANES) && defined(__AVX2__)
#include <immintrin.h>
#endif

namespace WEIR_API weir {

template <class T>
WEIR_HD T select(bool condition, const T& ifTrue, const T& ifFalse) {
  return condition ? ifTrue : ifFalse;
}

/// a, or zero where the condition does not hold.
WEIR_HD inline float zeroUnless(bool condition, float a) {
  return condition ? a : 0;
}
WEIR_HD inline double zeroUnless(bool condition, double a) {
  return condition ? a : 0;
}
/// Whether a condition holds for one of those that it is about.
WEIR_HD inline bool any(bool condition) {
  return condition;
}
/// For what is rarely to be done, and does nothing where the condition does not hold: false if it holds for
/// none of the lanes, which saves them the work. Always true for one number, where a select costs no more
/// than a branch.
WEIR_HD inline bool anyLane(bool) {
  return true;
}

/// Calls f(l) for each lane l where the condition holds, with 0 for one number.
template <class F>
WEIR_HD void forEachLane(bool condition, const F& f) {
  if (condition) f(0);
}
WEIR_HD inline float laneOf(float a, int /*lane*/) {
  return a;
}
WEIR_HD inline void setLane(float& a, int /*lane*/, float value) {
  a = value;
}
template <class T>
WEIR_HD Vec3f laneOf(const Vec3<T>& a, int lane) {
  return {laneOf(a.x, lane), laneOf(a.y, lane), laneOf(a.z, lane)};
}
template <class T>
WEIR_HD void setLane(Vec3<T>& a, int lane, const Vec3f& value) {
  setLane(a.x, lane, value.x);
  setLane(a.y, lane, value.y);
  setLane(a.z, lane, value.z);
}

/// t where it is above zero, otherwise (also where it is NaN) zero.
WEIR_HD inline float positivePart(float t) {
  return t > 0 ? t : 0;
}
WEIR_HD inline double positivePart(double t) {
  return t > 0 ? t : 0;
}

/// √x for kernels over pairs of particles, which spend much of their time on it: on CUDA it may be wrong in
/// its last bit, and 0 where x is below 10⁻³⁸.
WEIR_HD inline float fastSqrt(float x) {
#ifdef __CUDA_ARCH__
  float root;
  asm("sqrt.approx.ftz.f32 %0, %1;" : "=f"(root) : "f"(x));
  return root;
#else
  return sqrtf(x);
#endif
}

/// a/b likewise, wrong in its last two bits at most, where b is not above 2^126 and numbers are not below
/// 10⁻³⁸.
WEIR_HD inline float fastDivide(float a, float b) {
#ifdef __CUDA_ARCH__
  float ratio;
  asm("div.approx.ftz.f32 %0, %1, %2;" : "=f"(ratio) : "f"(a), "f"(b));
  return ratio;
#else
  return a / b;
#endif
}

#ifdef WEIR_HAS_LANES

/// What comparisons of Lanes give.
struct LaneMask {
  using Vector = std::int32_t __attribute__((vector_size(32)));
  Vector v;  // all bits of a lane are alike

  friend LaneMask operator&(const LaneMask& a, const LaneMask& b) { return {a.v & b.v}; }
  friend LaneMask operator|(const LaneMask& a, const LaneMask& b) { return {a.v | b.v}; }
  friend LaneMask operator!(const LaneMask& a) { return {~a.v}; }
  friend bool any(const LaneMask& a) { return a.bits() != 0; }
  friend bool anyLane(const LaneMask& a) { return __builtin_expect(any(a), false); }

  /// Bit l is that of lane l.
  unsigned bits() const {
#ifdef __AVX2__
    return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(v)));
#else
    unsigned bits = 0;
    for (int l = 0; l < 8; ++l) bits |= (static_cast<unsigned>(v[l]) & 1u) << l;
    return bits;
#endif
  }
};

/// Eight indices.
struct LaneInts {
  using Vector = std::int32_t __attribute__((vector_size(32)));
  using Anywhere __attribute__((vector_size(32), aligned(4), may_alias)) = std::int32_t;
  Vector v;

  /// first, first + 1, …, first + 7
  static LaneInts from(int first) { return {first + Vector{0, 1, 2, 3, 4, 5, 6, 7}}; }
  /// From any address.
  static LaneInts load(const int* from) {
    LaneInts lanes;
    __builtin_memcpy(&lanes.v, from, sizeof(Vector));
    return lanes;
  }
  /// To any address. By a type of its own, because a copy of bytes goes through memory or in halves.
  void store(int* to) const { *reinterpret_cast<Anywhere*>(to) = v; }

  LaneInts& operator-=(int b) {
    v -= b;
    return *this;
  }
  friend LaneMask operator<(const LaneInts& a, int b) { return {a.v < b}; }
  friend LaneMask operator>(const LaneInts& a, int b) { return {a.v > b}; }
  friend LaneMask operator>(const LaneInts& a, const LaneInts& b) { return {a.v > b.v}; }
  friend LaneMask operator!=(const LaneInts& a, int b) { return {a.v != b}; }
};

struct Lanes {
  static constexpr int kCount = 8;
  using Vector = float __attribute__((vector_size(32)));
  using Anywhere __attribute__((vector_size(32), aligned(4), may_alias)) = float;
  Vector v;

  Lanes() : v{} {}
  Lanes(const Vector& vector) : v(vector) {}
  Lanes(float all) : v{all, all, all, all, all, all, all, all} {}
  /// From any address.
  static Lanes load(const float* from) {
    Lanes lanes;
    __builtin_memcpy(&lanes.v, from, sizeof(Vector));
    return lanes;
  }
  /// To any address.
  void store(float* to) const { *reinterpret_cast<Anywhere*>(to) = v; }

  friend Lanes operator+(const Lanes& a, const Lanes& b) { return a.v + b.v; }
  friend Lanes operator-(const Lanes& a, const Lanes& b) { return a.v - b.v; }
  friend Lanes operator*(const Lanes& a, const Lanes& b) { return a.v * b.v; }
  friend Lanes operator/(const Lanes& a, const Lanes& b) { return a.v / b.v; }
  friend Lanes operator-(const Lanes& a) { return -a.v; }
  Lanes& operator+=(const Lanes& b) { return *this = *this + b; }
  Lanes& operator-=(const Lanes& b) { return *this = *this - b; }
  Lanes& operator*=(const Lanes& b) { return *this = *this * b; }

#ifdef __AVX2__
  // By name, because compilers for AVX-512 would make masks of comparisons and lanes of masks again.
  friend LaneMask operator<(const Lanes& a, const Lanes& b) {
    return mask(_mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ));
  }
  friend LaneMask operator>(const Lanes& a, const Lanes& b) {
    return b < a;
  }
  friend LaneMask operator==(const Lanes& a, const Lanes& b) {
    return mask(_mm256_cmp_ps(a.v, b.v, _CMP_EQ_OQ));
  }
  friend Lanes select(const LaneMask& condition, const Lanes& ifTrue, const Lanes& ifFalse) {
    return Vector(_mm256_blendv_ps(ifFalse.v, ifTrue.v, reinterpret_cast<__m256>(condition.v)));
  }
  friend Lanes positivePart(const Lanes& t) {
    return Vector(_mm256_max_ps(t.v, _mm256_setzero_ps()));
  }
#else
  friend LaneMask operator<(const Lanes& a, const Lanes& b) {
    return {a.v < b.v};
  }
  friend LaneMask operator>(const Lanes& a, const Lanes& b) {
    return {a.v > b.v};
  }
  friend LaneMask operator==(const Lanes& a, const Lanes& b) {
    return {a.v == b.v};
  }
  friend Lanes select(const LaneMask& condition, const Lanes& ifTrue, const Lanes& ifFalse) {
    return condition.v ? ifTrue.v : ifFalse.v;
  }
  friend Lanes positivePart(const Lanes& t) {
    return select(t > Lanes(0.0f), t, Lanes(0.0f));
  }
#endif
  /// Zero where the condition does not hold.
  friend Lanes zeroUnless(const LaneMask& condition, const Lanes& a) {
    return reinterpret_cast<Vector>(condition.v & reinterpret_cast<LaneMask::Vector>(a.v));
  }
  friend Lanes sqrtf(const Lanes& a) {
#ifdef __AVX2__
    return Vector(_mm256_sqrt_ps(a.v));
#else
    Lanes root;
    for (int l = 0; l < kCount; ++l) root.v[l] = __builtin_sqrtf(a.v[l]);
    return root;
#endif
  }
  friend Lanes abs(const Lanes& a) {
    return reinterpret_cast<Vector>(reinterpret_cast<LaneMask::Vector>(a.v) & 0x7fffffff);
  }
  friend Lanes fastSqrt(const Lanes& a) {
    return sqrtf(a);
  }
  friend Lanes fastDivide(const Lanes& a, const Lanes& b) {
    return a / b;
  }

#ifdef __AVX2__
 private:
  static LaneMask mask(__m256 bits) {
    return {reinterpret_cast<LaneMask::Vector>(bits)};
  }
#endif
};

inline Vec3<Lanes> select(const LaneMask& condition, const Vec3<Lanes>& ifTrue, const Vec3<Lanes>& ifFalse) {
  return {select(condition, ifTrue.x, ifFalse.x), select(condition, ifTrue.y, ifFalse.y),
          select(condition, ifTrue.z, ifFalse.z)};
}

template <class F>
[[gnu::always_inline]] inline void forEachLane(const LaneMask& condition, const F& f) {
  for (unsigned bits = condition.bits(); bits != 0; bits &= bits - 1) f(__builtin_ctz(bits));
}
inline float laneOf(const Lanes& a, int lane) {
  return a.v[lane];
}
inline void setLane(Lanes& a, int lane, float value) {
  a.v[lane] = value;
}

namespace detail {

using HalfLanes = float __attribute__((vector_size(16)));

/// lane[l] + lane[l + 4]: the first step of every sum over lanes.
inline HalfLanes foldLanes(const Lanes& a) {
  return __builtin_shufflevector(a.v, a.v, 0, 1, 2, 3) + __builtin_shufflevector(a.v, a.v, 4, 5, 6, 7);
}

#if defined(__AVX2__) && !defined(__AVX512VL__)
/// For each pattern of bits the lanes that it chooses, one a byte, the first of them in the lowest.
struct ChosenFirst {
  std::uint64_t lanes[256] = {};
  constexpr ChosenFirst() {
    for (unsigned bits = 0; bits < 256; ++bits) {
      int count = 0;
      for (std::uint64_t l = 0; l < 8; ++l) {
        if ((bits >> l) & 1u) lanes[bits] |= l << (8 * count++);
      }
    }
  }
};
inline constexpr ChosenFirst kChosenFirst;
#endif

}  // namespace detail

/// The angle of the point (x, y) about the origin, in [-π, π] and off by 3e-7 at most: the same on every
/// processor. It has the sign of y, also that of zero. 0 for the origin.
[[gnu::always_inline]] inline Lanes atan2(const Lanes& y, const Lanes& x) {
  constexpr float kPi = 3.14159265f, kTanOfEighth = 0.414213562f;  // tan(π/8)
  const Lanes across = abs(y), along = abs(x);
  const LaneMask steep = across > along;
  const Lanes low = select(steep, along, across), high = select(steep, across, along);
  // The angle is turned back by π/4 where it is above π/8. What is left has the polynomial of atanf in the
  // Cephes library.
  const LaneMask turned = low > kTanOfEighth * high;
  const Lanes below = select(turned, low + high, high);
  const Lanes t = zeroUnless(below > Lanes(0.0f), select(turned, low - high, low) / below), tt = t * t;
  Lanes angle =
      (((8.05374449538e-2f * tt - 1.38776856032e-1f) * tt + 1.99777106478e-1f) * tt - 3.33329491539e-1f) *
          tt * t +
      t;
  angle += zeroUnless(turned, Lanes(kPi / 4));
  angle = select(steep, kPi / 2 - angle, angle);
  angle = select(x < Lanes(0.0f), kPi - angle, angle);
  using Bits = LaneMask::Vector;
  const Bits sign = reinterpret_cast<Bits>(y.v) & static_cast<int>(0x80000000u);
  return Lanes(reinterpret_cast<Lanes::Vector>(reinterpret_cast<Bits>(angle.v) | sign));
}

/// The sum over the lanes.
inline float sumOfLanes(const Lanes& a) {
  const detail::HalfLanes h = detail::foldLanes(a);
  return (h[0] + h[2]) + (h[1] + h[3]);
}

/// The largest of the lanes.
inline int largest(const LaneInts& a) {
  using Half = std::int32_t __attribute__((vector_size(16)));
  const Half low = __builtin_shufflevector(a.v, a.v, 0, 1, 2, 3),
             high = __builtin_shufflevector(a.v, a.v, 4, 5, 6, 7);
  const Half four = low > high ? low : high;
  const Half swapped = __builtin_shufflevector(four, four, 2, 3, 0, 1);
  const Half two = four > swapped ? four : swapped;
  return two[0] > two[1] ? two[0] : two[1];
}
/// The smallest of the lanes, which are above -2³¹.
inline int smallest(const LaneInts& a) {
  return -largest(LaneInts{-a.v});
}

namespace detail {

inline HalfLanes rowOf(const Vec4f& element) {
  HalfLanes row;
  __builtin_memcpy(&row, &element, sizeof row);
  return row;
}
inline HalfLanes rowOf(const Vec3f& element) {
#ifdef WEIR_ADDRESS_SANITIZER
  return HalfLanes{element.x, element.y, element.z, 0};
#else
  // Four numbers, where there are only three at the end of an array: devices leave room behind it.
  HalfLanes row;
  __builtin_memcpy(&row, &element.x, sizeof row);
  return row;
#endif
}

/// Two rows, one behind the other.
template <class Element>
[[gnu::always_inline]] inline Lanes::Vector rowsOf(const Element& low, const Element& high) {
#ifdef __AVX2__
  // By name, so that the second row comes from memory into its place: compilers load it and move it there.
  return Lanes::Vector(_mm256_insertf128_ps(_mm256_castps128_ps256(rowOf(low)), rowOf(high), 1));
#else
  return __builtin_shufflevector(rowOf(low), rowOf(high), 0, 1, 2, 3, 4, 5, 6, 7);
#endif
}

/// The rows of eight elements as columns: two 4 by 4 matrices, side by side, are transposed.
template <class Element>
[[gnu::always_inline]] inline Vec4<Lanes> transposed(const Element* elements, const int* index) {
  const auto rows = [&](int l) { return rowsOf(elements[index[l]], elements[index[l + 4]]); };
  const Lanes::Vector a = rows(0), b = rows(1), c = rows(2), d = rows(3);
  const Lanes::Vector abLow = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  const Lanes::Vector abHigh = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  const Lanes::Vector cdLow = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
  const Lanes::Vector cdHigh = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  return {Lanes(__builtin_shufflevector(abLow, cdLow, 0, 1, 8, 9, 4, 5, 12, 13)),
          Lanes(__builtin_shufflevector(abLow, cdLow, 2, 3, 10, 11, 6, 7, 14, 15)),
          Lanes(__builtin_shufflevector(abHigh, cdHigh, 0, 1, 8, 9, 4, 5, 12, 13)),
          Lanes(__builtin_shufflevector(abHigh, cdHigh, 2, 3, 10, 11, 6, 7, 14, 15))};
}

}  // namespace detail

/// Elements index[0] to index[7] of a device's array, as eight lanes of each component. Inline, because lanes
/// that are returned go through memory.
[[gnu::always_inline]] inline Vec4<Lanes> gatherLanes(const Vec4f* elements, const int* index) {
  return detail::transposed(elements, index);
}
[[gnu::always_inline]] inline Vec3<Lanes> gatherLanes(const Vec3f* elements, const int* index) {
  const Vec4<Lanes> columns = detail::transposed(elements, index);
  return {columns.x, columns.y, columns.z};
}

/// Writes the lanes whose bits are set, in their order, to `to` and behind, and returns how many they are.
/// There must be room for all eight.
inline int storeChosen(int* to, const LaneInts& values, unsigned bits) {
#if defined(__AVX512VL__)
  const __m256i chosen =
      _mm256_maskz_compress_epi32(static_cast<__mmask8>(bits), reinterpret_cast<__m256i>(values.v));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), chosen);
  return __builtin_popcount(bits);
#elif defined(__AVX2__)
  const __m128i packed = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(&detail::kChosenFirst.lanes[bits]));
  const __m256i chosen =
      _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(values.v), _mm256_cvtepu8_epi32(packed));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), chosen);
  return __builtin_popcount(bits);
#else
  int count = 0;
  for (int l = 0; l < Lanes::kCount; ++l) {
    to[count] = values.v[l];
    count += static_cast<int>((bits >> l) & 1u);
  }
  return count;
#endif
}

#endif

// For loops over arrays within a call: Pack is as many floats as a turn handles, Lanes on the CPU and one
// float elsewhere.

#ifdef WEIR_HAS_LANES

using Pack = Lanes;

inline Pack loadPack(const float* from) {
  return Lanes::load(from);
}
/// Which of first, first + 1, … are below the end.
inline LaneMask packBelow(int first, int end) {
  return LaneInts::from(first) < end;
}
inline float sumOfPack(const Pack& a) {
  return sumOfLanes(a);
}
/// The numbers 0, 1, …
inline Pack countingPack() {
  return Lanes(Lanes::Vector{0, 1, 2, 3, 4, 5, 6, 7});
}
inline void storePack(float* to, const Pack& a) {
  __builtin_memcpy(to, &a.v, sizeof a.v);
}
/// Whether a turn has nothing to do where the condition does not hold; of eight, mostly one holds.
inline bool canSkip(const LaneMask&) {
  return false;
}

#else

using Pack = float;

WEIR_HD inline Pack loadPack(const float* from) {
  return *from;
}
WEIR_HD inline bool packBelow(int first, int end) {
  return first < end;
}
WEIR_HD inline float sumOfPack(Pack a) {
  return a;
}
WEIR_HD inline Pack countingPack() {
  return 0;
}
WEIR_HD inline void storePack(float* to, Pack a) {
  *to = a;
}
WEIR_HD inline bool canSkip(bool condition) {
  return !condition;
}

#endif

inline constexpr int kPack = sizeof(Pack) / sizeof(float);

}  // namespace weir
