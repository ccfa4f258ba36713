// Sums over the neighbours of a particle, or of eight particles at a time where the processor can.
#pragma once

#include "framework/base/api.h"
#include "framework/compute/eight.h"
#include "framework/neighbors/neighbor_list.h"
#include "framework/neighbors/packed_sum.h"

namespace WEIR_API weir {

namespace detail {

#ifdef WEIR_HAS_EIGHT

template <class T>
struct SumOfEight;
template <>
struct SumOfEight<float> {
  Lanes total;
  void add(const Lanes& term) { total += term; }
  void add(const LaneMask& counted, const Lanes& term) { add(zeroUnless(counted, term)); }
};
template <>
struct SumOfEight<Vec4f> {
  Vec4<Lanes> total;
  void add(const Vec4<Lanes>& term) {
    total.x += term.x;
    total.y += term.y;
    total.z += term.z;
    total.w += term.w;
  }
  void add(const LaneMask& counted, const Vec4<Lanes>& term) {
    add({zeroUnless(counted, term.x), zeroUnless(counted, term.y), zeroUnless(counted, term.z),
         zeroUnless(counted, term.w)});
  }
};

/// Lists are read once in each pass, with gaps between them that hardware does not foresee. Those of the next
/// particles come on their way here; mostly they are no longer than this, and what stands behind the last
/// lists is not touched.
[[gnu::always_inline]] inline void prefetchLists(const int* entries, int capacity) {
  constexpr int kAhead = 2, kLongest = 14, kInLine = 16;
  const int* ahead = entries + kAhead * kEight * capacity;
  for (int k = 0; k < kLongest * kEight; k += kInLine) __builtin_prefetch(ahead + k);
}

#endif

}  // namespace detail

/// Σ f(j, elements[j]…) over the neighbours j of particle i, for any number of arrays of Vec3f or Vec4f. T,
/// what is summed, is float or Vec4f. The order of summation is that of the list, everywhere.
///
/// f is a generic lambda: with an int and vectors of floats it returns a T, and where it is used with Eight,
/// too, with LaneInts and vectors of Lanes the same of Lanes. Its body may use what both know: arithmetic,
/// sqrtf, comparisons with select in place of branches, positivePart.
///
/// Inline, so that what f takes from its kernel is prepared once for all particles.
template <class T, class F, class... Element>
[[gnu::always_inline]] WEIR_HD inline T sumOverNeighbors(std::int64_t i, const NeighborView& list, const F& f,
                                                         const ArrayView<const Element>&... elements) {
#ifdef __CUDACC__
  return detail::sumPacked<T>(i, list.counts[i], list.packed, f, elements.data...);
#else
  T sum{};
  forEachNeighbor(i, list, [&](int j) { detail::addTo(sum, f(j, elements[j]...)); });
  return sum;
#endif
}

/// The same by a team, all of which have the sum then. On CUDA only.
template <class T, class F, class... Element>
[[gnu::always_inline]] WEIR_HD inline T sumOverNeighbors(const detail::TeamList& list, const F& f,
                                                         const ArrayView<const Element>&... elements) {
  return detail::sumPackedInTeam<T>(list, f, elements.data...);
}
template <class T, class F, class... Element>
[[gnu::always_inline]] WEIR_HD inline T sumOverNeighbors(const TeamIndex& at, const NeighborView& list,
                                                         const F& f,
                                                         const ArrayView<const Element>&... elements) {
  return sumOverNeighbors<T>(detail::TeamList(at, list.counts, list.packed), f, elements...);
}

template <class Index>
struct NeighborsOf {
  const Index& i;
  const NeighborView& list;
};
/// The neighbours of particle i, or of eight particles, to be summed over. A kernel asks for them before it
/// reads what the kernel before it may have written: a team reads lists ahead, which stand since the search,
/// and then waits for that kernel.
template <class Index>
WEIR_HD inline NeighborsOf<Index> neighborsOf(const Index& i, const NeighborView& list) {
  return {i, list};
}
WEIR_HD inline detail::TeamList neighborsOf(const TeamIndex& at, const NeighborView& list) {
  const detail::TeamList ahead(at, list.counts, list.packed);
  awaitBefore(at);
  return ahead;
}

/// An element that is needed after a sum, and that the kernel before leaves alone. A team, few threads that
/// wait for memory most of the time, reads it ahead of the sum (and not at all if it is not `wanted`);
/// others, which have no registers to spare, where it is asked for.
template <class T, class Index>
struct ReadAfterSum {
  const ArrayView<T>& from;
  const Index& i;
  WEIR_HD auto operator()() const { return read(from, i); }
};
template <class T>
struct ReadBeforeSum {
  T element;
  WEIR_HD const T& operator()() const { return element; }
};
template <class T, class Index>
WEIR_HD inline ReadAfterSum<T, Index> besideSum(const ArrayView<T>& from, const Index& i,
                                                [[maybe_unused]] bool wanted = true) {
  return {from, i};
}
template <class T>
WEIR_HD inline ReadBeforeSum<std::remove_const_t<T>> besideSum(const ArrayView<T>& from, const TeamIndex& i,
                                                               bool wanted = true) {
  if (!wanted) return {};
  return {readAhead(from, i)};
}

template <class T, class Index, class F, class... Element>
[[gnu::always_inline]] WEIR_HD inline auto sumOverNeighbors(const NeighborsOf<Index>& of, const F& f,
                                                            const ArrayView<const Element>&... elements) {
  return sumOverNeighbors<T>(of.i, of.list, f, elements...);
}

#ifdef WEIR_HAS_EIGHT

/// The same for eight particles, whose k-th neighbours stand side by side.
template <class T, class F, class... Element>
[[gnu::always_inline]] inline auto sumOverNeighbors(Eight i, const NeighborView& list, const F& f,
                                                    const ArrayView<const Element>&... elements) {
  LaneInts left = LaneInts::load(list.counts + i.first);
  const int* entry = list.list(i.first);
  const int shortest = smallest(left);
  const int* shortestEnd = entry + kEight * std::int64_t{shortest};
  const int* end = entry + kEight * std::int64_t{largest(left)};
  detail::prefetchLists(entry, list.capacity);
  detail::SumOfEight<T> sum;
  const auto term = [&]() __attribute__((always_inline)) {
    return f(LaneInts::load(entry), gatherLanes(elements.data, entry)...);
  };
  // As long as all lists go on there is nothing to leave out. What stands behind the shorter ones may be
  // followed as well.
  for (; entry != shortestEnd; entry += kEight) sum.add(term());
  for (left -= shortest; entry != end; entry += kEight, left -= 1) sum.add(left > 0, term());
  return sum.total;
}

#endif

}  // namespace weir
