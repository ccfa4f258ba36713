// Sums over the neighbours of a particle, eight of them at a time where the processor can.
#pragma once

#include "framework/compute/lanes.h"
#include "nodes/particles/neighbor_list.h"

namespace weir {

/// On the CPU lists are read in pieces of so many entries: most particles have one piece, so the processor
/// guesses right how the loop over them ends, and two groups of lanes are at work at a time.
inline constexpr int kListPiece = 16;

#if defined(WEIR_HAS_LANES) && defined(__AVX2__)
#define WEIR_SUMS_IN_LANES
#endif

namespace detail {

WEIR_HD inline void addTo(float& sum, float term) {
  sum += term;
}
WEIR_HD inline void addTo(Vec4f& sum, const Vec4f& term) {
  sum = {sum.x + term.x, sum.y + term.y, sum.z + term.z, sum.w + term.w};
}

#ifdef WEIR_SUMS_IN_LANES

template <class T>
struct SumInLanes;
template <>
struct SumInLanes<float> {
  Lanes total;
  void add(const LaneMask& counted, const Lanes& term) { total += keptWhere(counted, term); }
};
template <>
struct SumInLanes<Vec4f> {
  Vec4<Lanes> total;
  void add(const LaneMask& counted, const Vec4<Lanes>& term) {
    total.x += keptWhere(counted, term.x);
    total.y += keptWhere(counted, term.y);
    total.z += keptWhere(counted, term.z);
    total.w += keptWhere(counted, term.w);
  }
};

template <class T, class F, class... Element>
[[gnu::always_inline]] inline T sumInLanes(const int* entry, int count, const F& f,
                                           const Element*... elements) {
  SumInLanes<T> sum;
  const auto addEight = [&](int k) __attribute__((always_inline)) {
    LaneInts j;
    __builtin_memcpy(&j.v, entry + k, sizeof j.v);
    sum.add(LaneInts::from(k) < count, f(j, gatherLanes(elements, entry + k)...));
  };
  // The entries of a piece may all be followed, see NeighborView.
  for (int k = 0; k < count; k += kListPiece) {
    addEight(k);
    addEight(k + Lanes::kCount);
  }
  return sumOfLanes(sum.total);
}

#endif

/// The same sum one by one, bit for bit, for processors to which eight lanes are too wide.
template <class T, class F, class... Element>
T sumAsInLanes(const int* entry, int count, const F& f, const Element*... elements) {
  constexpr int kLanes = 8;
  T sums[kLanes] = {};
  for (int k = 0; k < count; ++k) addTo(sums[k % kLanes], f(entry[k], elements[entry[k]]...));
  for (int width = kLanes / 2; width > 0; width /= 2) {
    for (int l = 0; l < width; ++l) addTo(sums[l], sums[l + width]);
  }
  return sums[0];
}

}  // namespace detail

/// Σ f(j, elements[j]…) over the neighbours j of particle i, for any number of arrays of Vec3f or Vec4f. T,
/// what is summed, is float or Vec4f.
///
/// f is a generic lambda: with an int and vectors of floats it returns a T, with LaneInts and vectors of
/// Lanes the same of Lanes. Its body may use what both know: arithmetic, sqrtf, comparisons with select in
/// place of branches, positivePart. The order of summation differs between CPU and CUDA and is fixed on each.
///
/// Inline, so that what f takes from its kernel is prepared once for all particles.
template <class T, class F, class... Element>
[[gnu::always_inline]] WEIR_HD inline T sumOverNeighbors(std::int64_t i, const NeighborView& list, const F& f,
                                                         const ArrayView<const Element>&... elements) {
#if defined(WEIR_SUMS_IN_LANES)
  return detail::sumInLanes<T>(list.entries + i * list.capacity, list.counts[i], f, elements.data...);
#elif !defined(__CUDACC__)
  return detail::sumAsInLanes<T>(list.entries + i * list.capacity, list.counts[i], f, elements.data...);
#else
  T sum{};
  detail::forEachPacked(i, list.counts[i], list.packed,
                        [&](int j) { detail::addTo(sum, f(j, elements[j]...)); });
  return sum;
#endif
}

}  // namespace weir
