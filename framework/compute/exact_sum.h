// Sums of numbers that are the same bits in whatever order, and in however many parts, they are added.
//
// A term is cut into whole numbers of 1, 2^-31 and 2^-62, which are summed each for itself. What is below
// 2^-62 of a term is left out; terms must lie between -2^31 and 2^31, and there may be 2^31 of them. Terms
// that are NaN count as 0, those beyond as the bound.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "framework/base/host_device.h"

namespace weir {

struct ExactSum {
  std::int64_t ones = 0, fine = 0, finest = 0;  ///< of 1, 2^-31, 2^-62

  ExactSum() = default;
  WEIR_HD explicit ExactSum(double term) {
    constexpr double kMax = kUnits - 1;
    term = term > kMax ? kMax : (term < -kMax ? -kMax : (term == term ? term : 0.0));
    ones = static_cast<std::int64_t>(term);
    const double rest = (term - static_cast<double>(ones)) * kUnits;
    fine = static_cast<std::int64_t>(rest);
    finest = static_cast<std::int64_t>((rest - static_cast<double>(fine)) * kUnits);
  }

  WEIR_HD ExactSum& operator+=(const ExactSum& other) {
    ones += other.ones, fine += other.fine, finest += other.finest;
    return *this;
  }
  friend WEIR_HD ExactSum operator+(ExactSum a, const ExactSum& b) { return a += b; }

  double value() const { return double(ones) + (double(fine) + double(finest) / kUnits) / kUnits; }

 private:
  static constexpr double kUnits = 2147483648.0;  // 2^31
};

/// A power of two near a finite number above 0: scaling by it rounds nothing.
inline double powerBelow(double number) {
  constexpr int kLargest = 1000;  // such that its inverse is no subnormal number
  return std::ldexp(1.0, std::clamp(std::ilogb(number), -kLargest, kLargest));
}

enum class SumKind {
  kNumber,  ///< that is about 1 or less
  kScaled,  ///< that is summed in units of the caller's
  kMax      ///< the largest of all, at least 0
};

/// What the numbers of Sums are, which must be doubles only: scaled, unless Sums::kindOf(k) says otherwise of
/// the k-th.
template <class Sums>
struct SumKinds {
  static constexpr int kNumbers = static_cast<int>(sizeof(Sums) / sizeof(double));
  WEIR_HD static constexpr SumKind of([[maybe_unused]] int k) {
    if constexpr (requires { Sums::kindOf(0); })
      return Sums::kindOf(k);
    else
      return SumKind::kScaled;
  }
};

/// The largest finite one of the numbers of Sums, without its sign; 0 if there is none.
template <class Sums>
WEIR_HD double largestNumber(const Sums& of) {
  double numbers[SumKinds<Sums>::kNumbers], largest = 0;
  memcpy(numbers, &of, sizeof(numbers));
  for (const double number : numbers) {
    const double size = number < 0 ? -number : number;
    if (size > largest && size - size == 0) largest = size;
  }
  return largest;
}

/// The same numbers, with exact sums. At most one of them is a maximum.
template <class Sums>
struct ExactSums {
  using Kinds = SumKinds<Sums>;

  ExactSum sums[Kinds::kNumbers];
  double max = 0;

  ExactSums() = default;
  WEIR_HD ExactSums(const Sums& term, double perUnit) {
    double numbers[Kinds::kNumbers];
    memcpy(numbers, &term, sizeof(numbers));
    for (int k = 0; k < Kinds::kNumbers; ++k) {
      if (Kinds::of(k) == SumKind::kMax)
        max = numbers[k];
      else
        sums[k] = ExactSum(Kinds::of(k) == SumKind::kScaled ? perUnit * numbers[k] : numbers[k]);
    }
  }

  WEIR_HD ExactSums& operator+=(const ExactSums& other) {
    for (int k = 0; k < Kinds::kNumbers; ++k) sums[k] += other.sums[k];
    if (other.max > max) max = other.max;
    return *this;
  }
  friend WEIR_HD ExactSums operator+(ExactSums a, const ExactSums& b) { return a += b; }

  Sums value(double unit) const {
    double numbers[Kinds::kNumbers];
    for (int k = 0; k < Kinds::kNumbers; ++k) {
      const double scale = Kinds::of(k) == SumKind::kScaled ? unit : 1;
      numbers[k] = Kinds::of(k) == SumKind::kMax ? max : scale * sums[k].value();
    }
    Sums all;
    std::memcpy(&all, numbers, sizeof(all));
    return all;
  }
};

}  // namespace weir
