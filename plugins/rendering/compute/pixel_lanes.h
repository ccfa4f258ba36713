// Numbers of the kernels that work on whole pictures: eight neighbouring pixels at a time on the CPU, one at
// a time on CUDA. A kernel that is written with Number, Ints and Mask is right for both.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "framework/base/vec.h"
#include "framework/compute/lanes.h"

namespace weir::rendering {

// One number at a time, as formulas take it everywhere.

/// The larger one; `low` where x is NaN.
WEIR_HD inline float atLeast(float x, float low) {
  return x > low ? x : low;
}
/// The smaller one; `high` where x is NaN.
WEIR_HD inline float atMost(float x, float high) {
  return x < high ? x : high;
}
WEIR_HD inline float absolute(float x) {
  return std::fabs(x);
}
WEIR_HD inline float exponential(float x) {
  return std::exp(x);
}
WEIR_HD inline float power(float x, float exponent) {
  return std::pow(x, exponent);
}

#ifdef WEIR_HAS_LANES

using Number = Lanes;
using Mask = LaneMask;
using Ints = LaneInts::Vector;  // the compiler knows its arithmetic
inline constexpr int kPixels = Lanes::kCount;

/// first, first + 1, …
inline Ints intsFrom(int first) {
  return LaneInts::from(first).v;
}
inline Ints allInts(int value) {
  return Ints{} + value;
}
inline Number toNumbers(const Ints& ints) {
  return Lanes(__builtin_convertvector(ints, Lanes::Vector));
}
/// Without the part behind the point.
inline Ints toInts(const Number& numbers) {
  return __builtin_convertvector(numbers.v, Ints);
}
inline Number numbersOfBits(const Ints& bits) {
  return Lanes(reinterpret_cast<Lanes::Vector>(bits));
}
inline Ints bitsOfNumbers(const Number& numbers) {
  return reinterpret_cast<Ints>(numbers.v);
}
inline Ints selectInts(const Mask& condition, const Ints& ifTrue, const Ints& ifFalse) {
  return (condition.v & ifTrue) | (~condition.v & ifFalse);
}
inline Mask equal(const Ints& a, int b) {
  return {a == b};
}
inline Mask below(const Ints& a, int b) {
  return {a < b};
}
inline unsigned bitsOfMask(const Mask& mask) {
  return mask.bits();
}
inline std::uint32_t laneOf(const Ints& ints, int lane) {
  return static_cast<std::uint32_t>(ints[lane]);
}
inline Ints clamped(const Ints& x, int low, int high) {
  const Ints lowest = allInts(low), highest = allInts(high);
  const Ints above = x > lowest ? x : lowest;
  return above < highest ? above : highest;
}
inline Number atLeast(const Number& x, const Number& low) {
#ifdef __AVX2__
  return Lanes::Vector(_mm256_max_ps(x.v, low.v));
#else
  return select(x > low, x, low);
#endif
}
inline Number atMost(const Number& x, const Number& high) {
#ifdef __AVX2__
  return Lanes::Vector(_mm256_min_ps(x.v, high.v));
#else
  return select(x < high, x, high);
#endif
}

inline void setLane(Ints& ints, int lane, std::uint32_t value) {
  ints[lane] = static_cast<int>(value);
}

namespace detail {

/// 2^x for |x| < 126: Taylor's series around the next whole number, to one unit of the last bit or two.
inline Number powerOfTwo(const Number& x) {
  constexpr float kRound = 12582912;  // 1.5 · 2^23: adding it leaves whole numbers only
  const Number whole = (x + kRound) - kRound;
  const Number t = (x - whole) * 0.693147181f;
  const Number part =
      1 + t * (1 + t * (0.5f + t * (0.166666667f +
                                    t * (0.0416666667f + t * (8.33333333e-3f + t * 1.38888889e-3f)))));
  return part * numbersOfBits((toInts(whole) + 127) << 23);
}

/// The logarithm to base 2 of normal positive numbers, by the series of the inverse hyperbolic tangent.
inline Number logarithmToTwo(const Number& x) {
  constexpr int kRootOfHalf = 0x3f3504f3;  // the bits of √½: mantissas are from there to √2
  const Ints exponent = (bitsOfNumbers(x) - kRootOfHalf) >> 23;
  const Number mantissa = numbersOfBits(bitsOfNumbers(x) - (exponent << 23));
  const Number s = (mantissa - 1) / (mantissa + 1), q = s * s;
  const Number series = s * (1 + q * (0.333333333f + q * (0.2f + q * (0.142857143f + q * 0.111111111f))));
  return toNumbers(exponent) + 2.88539008f * series;
}

}  // namespace detail

inline Number absolute(const Number& x) {
  return abs(x);
}
/// e^x for x from -87 to 87.
inline Number exponential(const Number& x) {
  return detail::powerOfTwo(x * 1.44269504f);
}
/// x^exponent for normal x > 0.
inline Number power(const Number& x, float exponent) {
  return detail::powerOfTwo(exponent * detail::logarithmToTwo(x));
}

#else

using Number = float;
using Mask = bool;
using Ints = int;
inline constexpr int kPixels = 1;

WEIR_HD inline Ints intsFrom(int first) {
  return first;
}
WEIR_HD inline Ints allInts(int value) {
  return value;
}
WEIR_HD inline Number toNumbers(Ints ints) {
  return static_cast<float>(ints);
}
WEIR_HD inline Ints toInts(Number numbers) {
  return static_cast<int>(numbers);
}
WEIR_HD inline Number numbersOfBits(Ints bits) {
  return std::bit_cast<float>(bits);
}
WEIR_HD inline Ints bitsOfNumbers(Number numbers) {
  return std::bit_cast<int>(numbers);
}
WEIR_HD inline Ints selectInts(Mask condition, Ints ifTrue, Ints ifFalse) {
  return condition ? ifTrue : ifFalse;
}
WEIR_HD inline Mask equal(Ints a, int b) {
  return a == b;
}
WEIR_HD inline Mask below(Ints a, int b) {
  return a < b;
}
WEIR_HD inline unsigned bitsOfMask(Mask mask) {
  return mask ? 1 : 0;
}
using weir::laneOf;  // of a Number; the next one would hide it
WEIR_HD inline std::uint32_t laneOf(Ints ints, int) {
  return static_cast<std::uint32_t>(ints);
}
WEIR_HD inline Ints clamped(Ints x, int low, int high) {
  return x > low ? (x < high ? x : high) : low;
}
using weir::setLane;
WEIR_HD inline void setLane(Ints& ints, int, std::uint32_t value) {
  ints = static_cast<int>(value);
}

#endif

using Numbers3 = Vec3<Number>;

// What stands at several places of the memory.

WEIR_HD inline int indexOf(const Ints& at, int lane) {
  return static_cast<int>(laneOf(at, lane));
}
WEIR_HD inline Number gather(const float* from, const Ints& at) {
#if defined(WEIR_HAS_LANES) && defined(__AVX2__)
  return Lanes::Vector(_mm256_i32gather_ps(from, reinterpret_cast<__m256i>(at), 4));
#else
  Number values = 0.0f;
  for (int l = 0; l < kPixels; ++l) setLane(values, l, from[indexOf(at, l)]);
  return values;
#endif
}
/// Elements that stand side by side.
WEIR_HD inline void gatherPairs(const float* from, const Ints& at, Number& first, Number& second) {
#if defined(WEIR_HAS_LANES) && defined(__AVX2__)
  const __m256i places = reinterpret_cast<__m256i>(at);
  const auto* pairs = reinterpret_cast<const long long*>(from);
  const __m256 low =
      _mm256_castsi256_ps(_mm256_i32gather_epi64(pairs, _mm256_castsi256_si128(places), sizeof(float)));
  const __m256 high =
      _mm256_castsi256_ps(_mm256_i32gather_epi64(pairs, _mm256_extracti128_si256(places, 1), sizeof(float)));
  const Lanes::Vector a = low, b = high;
  first = Lanes::Vector(__builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14));
  second = Lanes::Vector(__builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15));
#else
  first = gather(from, at);
  second = gather(from + 1, at);
#endif
}
/// Upper halves.
WEIR_HD inline Ints gatherUpper(const std::uint64_t* from, const Ints& at) {
#if defined(WEIR_HAS_LANES) && defined(__AVX2__)
  return reinterpret_cast<Ints>(
      _mm256_i32gather_epi32(reinterpret_cast<const int*>(from) + 1, reinterpret_cast<__m256i>(at), 8));
#else
  Ints values = at;
  for (int l = 0; l < kPixels; ++l)
    setLane(values, l, static_cast<std::uint32_t>(from[indexOf(at, l)] >> 32));
  return values;
#endif
}
WEIR_HD inline void gatherHalves(const std::uint64_t* from, const Ints& at, Ints& lower, Ints& upper) {
#if defined(WEIR_HAS_LANES) && defined(__AVX2__)
  const __m256i places = reinterpret_cast<__m256i>(at);
  const auto* whole = reinterpret_cast<const long long*>(from);
  const Ints a = reinterpret_cast<Ints>(_mm256_i32gather_epi64(whole, _mm256_castsi256_si128(places), 8));
  const Ints b =
      reinterpret_cast<Ints>(_mm256_i32gather_epi64(whole, _mm256_extracti128_si256(places, 1), 8));
  lower = __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14);
  upper = __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15);
#else
  for (int l = 0; l < kPixels; ++l) {
    const std::uint64_t whole = from[indexOf(at, l)];
    setLane(lower, l, static_cast<std::uint32_t>(whole));
    setLane(upper, l, static_cast<std::uint32_t>(whole >> 32));
  }
#endif
}
/// Numbers first, first + 1, … of a row of `size`; the nearest that there is for those that lie outside.
WEIR_HD inline Number rowFrom(const float* row, int first, int size) {
#ifdef WEIR_HAS_LANES
  if (first >= 0 && first + kPixels <= size) return Lanes::load(row + first);
#endif
  return gather(row, clamped(intsFrom(first), 0, size - 1));
}

/// The same for all pixels.
WEIR_HD inline Numbers3 allOf(const Vec3f& v) {
  return {Number(v.x), Number(v.y), Number(v.z)};
}
template <class N>
WEIR_HD N clamped(const N& x, float low, float high) {
  return atMost(atLeast(x, low), high);
}
template <class N>
WEIR_HD N mix(const N& a, const N& b, const std::type_identity_t<N>& t) {
  return a + (b - a) * t;
}
template <class N>
WEIR_HD Vec3<N> mix(const Vec3<N>& a, const Vec3<N>& b, const std::type_identity_t<N>& t) {
  return a + (b - a) * t;
}
template <class N>
WEIR_HD Vec3<N> times(const Vec3<N>& a, const Vec3<N>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <class N>
WEIR_HD N smoothstep(float low, float high, const N& x) {
  const N t = clamped((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}
/// The unit vector along v; zero for zero.
WEIR_HD inline Numbers3 unit(const Numbers3& v) {
  const Number size = sqrtf(dot(v, v));
  return v * select(size > Number(0.0f), 1 / size, Number(0.0f));
}
/// The whole number below x, and what x has beyond it; |x| < 2^31.
WEIR_HD inline Ints split(const Number& x, Number& beyond) {
  const Ints cut = toInts(x);
  const Number low = toNumbers(cut);
  const Mask below = x < low;
  beyond = x - select(below, low - 1, low);
  return selectInts(below, cut - 1, cut);
}
/// The nearest whole number, the even one of two; |x| < 2^22.
WEIR_HD inline Ints nearestInts(const Number& x) {
  constexpr float kRound = 12582912;  // 1.5 · 2^23: adding it leaves whole numbers only
  return toInts((x + kRound) - kRound);
}
/// 0 … 1 as a byte.
WEIR_HD inline Ints bytesOf(const Number& x) {
  return toInts(clamped(x, 0.0f, 1.0f) * 255.0f + 0.5f);
}

}  // namespace weir::rendering
