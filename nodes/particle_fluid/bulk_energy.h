// Bulk energies B(λ) of semi-implicit incompressible SPH (paper, section 5.1) as polynomials.
//
// The derivative is Ḃ(λ) = Σ c_k·(λ^k − 1) with c_k ≥ 0, so that Ḃ(1) = 0, Ḃ⁺ = Σ c_k·λ^k and the constant
// Ḃ⁻ = −Σ c_k. The paper's B0, B1 and B2 have a single c_k = 1 for k = 1, 2 and 3 (Eq. 15 to 17). It is kept
// as a polynomial of the excess e = λ − 1, whose value near rest loses no digits.
#pragma once

#include <array>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/host_device.h"
#include "framework/graph/param_types.h"

namespace WEIR_API weir {

enum class EnergyName { kB0, kB1, kB2, kPolynomial };
template <>
struct EnumNames<EnergyName> {
  static constexpr std::array<EnumName, 4> kNames{
      EnumName{"b0", "(λ − 1)²/2: needs no search for the step length."},
      EnumName{"b1", "(λ³ − 1)/3 − λ + 1: twice as stiff at rest, and stiffer under compression."},
      EnumName{"b2",
               "(λ⁴ − 1)/4 − λ + 1: three times as stiff at rest, and stiffer still under compression."},
      EnumName{"polynomial", "The one whose derivative the parameter polynomial gives."}};
};

class BulkEnergy {
 public:
  static constexpr int kMaxTerms = 8;

  /// B0.
  BulkEnergy() : BulkEnergy(std::vector<float>{1}) {}
  /// From c_1, c_2, …; at most kMaxTerms, none negative, one above zero.
  explicit BulkEnergy(const std::vector<float>& coefficients) : terms_(int(coefficients.size())) {
    for (int k = 1; k <= terms_; ++k) {
      const float c = coefficients[std::size_t(k - 1)];
      constant_ += c;
      double binomial = 1;  // λ^k = (1 + e)^k = Σ binomial(k, n)·e^n
      for (int n = 1; n <= k; ++n) {
        binomial *= double(k - n + 1) / n;
        ofExcess_[n - 1] += float(binomial) * c;
      }
    }
  }

  /// Ḃ at excess e = λ − 1, or at eight of them.
  template <class T>
  WEIR_HD T derivative(const T& e) const {
    T sum = 0;
    for (int n = terms_ - 1; n >= 0; --n) sum = sum * e + ofExcess_[n];
    return sum * e;
  }
  /// B at excess e, with B = 0 at rest.
  WEIR_HD float value(float e) const {
    float sum = 0;
    for (int n = terms_ - 1; n >= 0; --n) sum = sum * e + ofExcess_[n] / float(n + 2);
    return sum * e * e;
  }
  /// |Ḃ⁻|.
  WEIR_HD float negativePart() const { return constant_; }

 private:
  int terms_;
  float constant_ = 0;
  float ofExcess_[kMaxTerms] = {};  // of e, e², …
};

}  // namespace weir
