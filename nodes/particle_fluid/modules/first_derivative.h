// Ḃ, the derivative of the bulk energy, at the predicted positions of SemiImplicitSolver: from the kernel's
// sum that the search for neighbours has made on its way (NeighborList::crowding and places).
#pragma once

#include "framework/compute/eight.h"
#include "framework/compute/wide_access.h"
#include "nodes/particle_fluid/bulk_energy.h"

namespace weir::detail {

/// e = λ − 1, where it counts.
template <class T>
WEIR_HD T excessOf(const T& lambda, bool tension) {
  return tension ? lambda - 1 : positivePart(lambda - 1);
}

/// Ḃ as it stands beside a position.
struct AsStored {
  static constexpr bool kFirst = false;
  template <class T>
  WEIR_HD const T& operator()(const T& derivative) const {
    return derivative;
  }
};

/// Where the crowding stands there in place of Ḃ, which is then factor·e: in the first of several iterations.
struct OfCrowding {
  static constexpr bool kFirst = true;
  float volumeAtZero;  // V0·W(0)
  float least;         // that e may be
  float factor;

  WEIR_HD float operator()(float crowding) const {
    const float e = volumeAtZero * crowding - 1;
    return factor * (e > least ? e : least);
  }
};

/// Makes positions weighted with Ḃ of what the search has summed.
struct FirstDerivative {
  float volumeAtZero;  // V0·W(0)
  BulkEnergy energy;
  bool tension;
  ArrayView<const Vec3f> predicted;
  ArrayView<const float> crowding;
  ArrayView<Vec4f> weighted;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    const auto p = read(predicted, i);
    const auto e = excessOf(volumeAtZero * read(crowding, i), tension);
    write(weighted, i, {p.x, p.y, p.z, energy.derivative(e)});
  }
};

/// The same where the search has left position and crowding, for CUDA.
struct DerivativeOfPlace {
  float volumeAtZero;
  BulkEnergy energy;
  bool tension;
  ArrayView<Vec4f> places;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec4f at = loadWhole(places[i]);
    storeWhole(places[i], {at.x, at.y, at.z, energy.derivative(excessOf(volumeAtZero * at.w, tension))});
  }
};

}  // namespace weir::detail
