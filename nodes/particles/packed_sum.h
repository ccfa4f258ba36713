// Sums over packed lists on CUDA: by a thread for each particle, or by a team where particles are few.
#pragma once

#include <tuple>
#include <type_traits>

#include "framework/compute/eight.h"
#include "nodes/particles/packed_lists.h"

namespace weir {

/// The index of an element that a team handles together (parallelForSums): all of its threads read it and sum
/// over its neighbours, one writes.
struct TeamIndex {
  std::int64_t i;
  Team team;
};

template <class T>
WEIR_HD std::remove_const_t<T> read(const ArrayView<T>& from, const TeamIndex& at) {
  return read(from, at.i);
}
template <class T>
WEIR_HD void write(const ArrayView<T>& to, const TeamIndex& at, const std::type_identity_t<T>& value) {
  if (at.team.lane == 0) write(to, at.i, value);
}
WEIR_HD inline int asInt(const TeamIndex& at) {
  return asInt(at.i);
}

namespace detail {

WEIR_HD inline void addTo(float& sum, float term) {
  sum += term;
}
WEIR_HD inline void addTo(Vec4f& sum, const Vec4f& term) {
  sum = {sum.x + term.x, sum.y + term.y, sum.z + term.z, sum.w + term.w};
}

WEIR_HD inline float sumOf(const Team& team, float value) {
  return team.sum(value);
}
WEIR_HD inline Vec4f sumOf(const Team& team, const Vec4f& value) {
  return {team.sum(value.x), team.sum(value.y), team.sum(value.z), team.sum(value.w)};
}

/// Adds f(j, elements[j]…) for the first `left` of four neighbours, all of them if kFull. All are loaded
/// before the first is used.
template <bool kFull, class T, class F, class... Element>
WEIR_HD inline void addFour(T& sum, int left, const int (&j)[kCodesTogether], const F& f,
                            const Element*... elements) {
  std::tuple<Element...> rows[kCodesTogether];
  for (int l = 0; l < kCodesTogether; ++l)
    if (kFull || l < left) rows[l] = std::tuple<Element...>(loadWhole(elements[j[l]])...);
  for (int l = 0; l < kCodesTogether; ++l) {
    const int neighbor = j[l];
    const T term = std::apply([&](const auto&... element) { return f(neighbor, element...); }, rows[l]);
    if (kFull || l < left) addTo(sum, term);
  }
}

/// Σ f(j, elements[j]…) over the neighbours j of particle i. The next four codes are on their way while four
/// neighbours are added.
template <class T, class F, class... Element>
WEIR_HD inline T sumPacked(std::int64_t i, int count, const PackedLists& lists, const F& f,
                           const Element*... elements) {
  const ListGroup group = lists.groups[i / kListGroup];
  T sum{};
  if (group.wide != 0) {
    const int* index = lists.indicesOf(i, group.wide);
    for (int k = 0; k < count; ++k, index += kListGroup)
      addTo(sum, f(*index, loadWhole(elements[*index])...));
    return sum;
  }
  const FourCodes* codes = lists.codesOf(i);
  FourCodes next{};
  if (count > 0) next = *codes;
  int j[kCodesTogether];
  const auto takeFour = [&](int left) {
    next.to(j);
    codes += kListGroup;
    if (left > kCodesTogether) next = *codes;
    for (int l = 0; l < kCodesTogether; ++l) j[l] = group.decode(j[l]);
  };
  int left = count;
  for (; left >= kCodesTogether; left -= kCodesTogether) {
    takeFour(left);
    addFour<true>(sum, left, j, f, elements...);
  }
  if (left > 0) {
    takeFour(left);
    addFour<false>(sum, left, j, f, elements...);
  }
  return sum;
}

/// The same by a team, each of which takes every n-th neighbour. The order depends on the team's size, too.
template <class T, class F, class... Element>
WEIR_HD inline T sumPackedInTeam(const TeamIndex& at, int count, const PackedLists& lists, const F& f,
                                 const Element*... elements) {
  // Codes are there whatever their number: those of the first two neighbours of each thread are read along
  // with the rest, and both neighbours at once.
  constexpr int kAtOnce = 2;
  int code[kAtOnce];
  for (int l = 0; l < kAtOnce; ++l) {
    const int k = at.team.lane + l * at.team.size;
    code[l] = k < lists.capacity ? *lists.code(at.i, k) : 0;
  }
  const ListGroup group = lists.groups[at.i / kListGroup];
  T sum{};
  int k = at.team.lane;
  if (group.wide == 0) {
    std::tuple<Element...> rows[kAtOnce];
    for (int l = 0; l < kAtOnce; ++l)
      if (k + l * at.team.size < count)
        rows[l] = std::tuple<Element...>(loadWhole(elements[group.decode(code[l])])...);
    for (int l = 0; l < kAtOnce; ++l, k += at.team.size)
      if (k < count)
        addTo(sum, std::apply([&](const auto&... e) { return f(group.decode(code[l]), e...); }, rows[l]));
  }
  const int* index = group.wide == 0 ? nullptr : lists.indicesOf(at.i, group.wide);
  for (; k < count; k += at.team.size) {
    const int j = index != nullptr ? index[k * kListGroup] : group.decode(*lists.code(at.i, k));
    addTo(sum, f(j, loadWhole(elements[j])...));
  }
  return sumOf(at.team, sum);
}

template <class F>
struct CallWithTeamIndex {
  F f;
  WEIR_HD void operator()(std::int64_t i, const Team& team) const { f(TeamIndex{i, team}); }
};

}  // namespace detail

/// Calls f(i) for every i in [0, count) as parallelForEights does; or, where few of them leave most of a GPU
/// idle and a thread would wait for each of its neighbours in turn, f(TeamIndex) by teams.
template <class Backend, class F>
void parallelForSums(Backend& device, std::string_view name, Count count, const F& f) {
  if constexpr (std::is_same_v<Backend, CudaDevice>) {
    constexpr TeamPlan kPlan{8, 1 << 15};
    if (count.bound <= kPlan.few)
      return parallelForTeams(device, name, count, kPlan, detail::CallWithTeamIndex<F>{f});
  }
  parallelForEights(device, name, count, f);
}

}  // namespace weir
