// Sums of numbers that are the same bits in whatever order, and in however many parts, they are added.
//
// A term is cut into whole numbers of 1, 2^-31 and 2^-62, which are summed each for itself. What is below
// 2^-62 of a term is left out; terms must lie between -2^31 and 2^31, and there may be 2^31 of them. Terms
// that are NaN count as 0, those beyond as the bound.
#pragma once

#include <cmath>
#include <cstdint>

#include "framework/base/host_device.h"

namespace weir {

struct ExactSum {
  std::int64_t ones = 0, fine = 0, finest = 0;  ///< of 1, 2^-31, 2^-62

  ExactSum() = default;
  WEIR_HD explicit ExactSum(double term) {
    constexpr double kMax = kUnits - 1;
    term = term > kMax ? kMax : (term < -kMax ? -kMax : (term == term ? term : 0.0));
    const double whole = trunc(term), rest = (term - whole) * kUnits;
    const double middle = trunc(rest);
    ones = static_cast<std::int64_t>(whole);
    fine = static_cast<std::int64_t>(middle);
    finest = static_cast<std::int64_t>(trunc((rest - middle) * kUnits));
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

}  // namespace weir
