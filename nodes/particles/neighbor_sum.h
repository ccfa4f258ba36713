// Sums over the neighbours of a particle, eight of them at a time where the processor can.
#pragma once

#include "framework/compute/lanes.h"
#include "nodes/particles/neighbor_list.h"

namespace weir {

WEIR_HD inline void addTo(float& sum, float term) {
  sum += term;
}
WEIR_HD inline void addTo(Vec4f& sum, const Vec4f& term) {
  sum = {sum.x + term.x, sum.y + term.y, sum.z + term.z, sum.w + term.w};
}

#ifdef WEIR_HAS_LANES

namespace detail {

template <class T>
struct SumInLanes;
template <>
struct SumInLanes<float> {
  Lanes total;
  void add(const LaneMask& counted, const Lanes& term) { total += select(counted, term, Lanes()); }
};
template <>
struct SumInLanes<Vec4f> {
  Vec4<Lanes> total;
  void add(const LaneMask& counted, const Vec4<Lanes>& term) {
    total.x += select(counted, term.x, Lanes());
    total.y += select(counted, term.y, Lanes());
    total.z += select(counted, term.z, Lanes());
    total.w += select(counted, term.w, Lanes());
  }
};

}  // namespace detail

#endif

/// Σ f(j, elements[j]…) over the neighbours j of particle i, for any number of arrays of Vec3f or Vec4f. T,
/// what is summed, is float or Vec4f.
///
/// f is a generic lambda: with an int and vectors of floats it returns a T, with LaneInts and vectors of
/// Lanes the same of Lanes. Its body may use what both know: arithmetic, sqrtf, comparisons with select in
/// place of branches, positivePart. The order of summation differs between CPU and CUDA and is fixed on each.
template <class T, class F, class... Element>
WEIR_HD inline T sumOverNeighbors(std::int64_t i, const NeighborView& list, const F& f,
                                  const ArrayView<const Element>&... elements) {
  const int count = list.counts[i];
  const int* entry = list.entries + list.first(i);
#ifdef WEIR_HAS_LANES
  detail::SumInLanes<T> sum;
  // Lists are filled up to a multiple of eight with entries that may be read (see NeighborView).
  for (int k = 0; k < count; k += Lanes::kCount) {
    LaneInts j;
    __builtin_memcpy(&j.v, entry + k, sizeof j.v);
    sum.add(LaneInts::from(k) < count, f(j, gatherLanes(elements.data, entry + k)...));
  }
  return sumOfLanes(sum.total);
#else
  T sum{};
  const int stride = 1 << list.shift;
  for (int k = 0; k < count; ++k, entry += stride) addTo(sum, f(*entry, elements[*entry]...));
  return sum;
#endif
}

}  // namespace weir
