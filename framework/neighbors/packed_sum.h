// Sums over packed lists on CUDA: by a thread for each particle, or by a team where particles are few.
#pragma once

#include <tuple>
#include <type_traits>

#include "framework/base/api.h"
#include "framework/compute/eight.h"
#include "framework/neighbors/packed_lists.h"

namespace WEIR_API weir {

inline constexpr int kSumTeam = 8;  // threads

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
  if (at.team.lane == 0 && !at.team.spare) write(to, at.i, value);
}
WEIR_HD inline int asInt(const TeamIndex& at) {
  return asInt(at.i);
}

#ifdef __CUDACC__
__device__ inline ListGroup loadPastCache(const ListGroup& group) {
  const int4 v = __ldcg(reinterpret_cast<const int4*>(&group));
  return {{v.x, v.y, v.z}, v.w};
}
#endif

/// Something that the kernel before leaves alone, before awaitBefore(). Elsewhere kernels do not overlap.
template <class T>
WEIR_HD T readAhead(const T& element) {
#ifdef __CUDA_ARCH__
  return loadPastCache(element);
#else
  return element;
#endif
}
template <class T>
WEIR_HD std::remove_const_t<T> readAhead(const ArrayView<T>& from, const TeamIndex& at) {
  return readAhead<std::remove_const_t<T>>(from[at.i]);
}
/// What the kernel before has written is there from here on (kernel_overlap.h).
WEIR_HD inline void awaitBefore([[maybe_unused]] const TeamIndex& at) {
#ifdef __CUDA_ARCH__
  detail::waitForPriorKernel();
#endif
}
template <class Index>
WEIR_HD void awaitBefore(const Index&) {}

namespace detail {

WEIR_HD inline void addTo(float& sum, float term) {
  sum += term;
}
WEIR_HD inline void addTo(Vec4f& sum, const Vec4f& term) {
  sum = {sum.x + term.x, sum.y + term.y, sum.z + term.z, sum.w + term.w};
}

/// What a thread of its team adds, kSumTeam / 2, …, 2, 1 threads away. All teams of a warp ask together, so
/// that the compiler need not find out who does: that took longer than the sum.
WEIR_HD inline float sumInStep(float value, [[maybe_unused]] int away) {
#ifdef __CUDA_ARCH__
  value += __shfl_xor_sync(~0u, value, away);
#endif
  return value;
}

/// Σ value over the team, the same for all.
WEIR_HD inline float sumOfTeam(float sum) {
#ifdef __CUDA_ARCH__
#pragma unroll
#endif
  for (int away = kSumTeam / 2; away > 0; away /= 2) sum = sumInStep(sum, away);
  return sum;
}
WEIR_HD inline Vec4f sumOfTeam(Vec4f sum) {
#ifdef __CUDA_ARCH__
#pragma unroll
#endif
  for (int away = kSumTeam / 2; away > 0; away /= 2)
    sum = {sumInStep(sum.x, away), sumInStep(sum.y, away), sumInStep(sum.z, away), sumInStep(sum.w, away)};
  return sum;
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

/// Σ f(j, elements[j]…) over `count` neighbours, of which take(left, j) gives the next four.
template <class T, class Take, class F, class... Element>
WEIR_HD inline T sumByFours(int count, const Take& take, const F& f, const Element*... elements) {
  T sum{};
  int j[kCodesTogether];
  int left = count;
  for (; left >= kCodesTogether; left -= kCodesTogether) {
    take(left, j);
    addFour<true>(sum, left, j, f, elements...);
  }
  if (left > 0) {
    take(left, j);
    addFour<false>(sum, left, j, f, elements...);
  }
  return sum;
}

/// Σ f(j, elements[j]…) over the neighbours j of particle i. The next four codes are on their way while four
/// neighbours are added. Wide groups add by fours, too: compilers fuse products into sums where they find
/// both side by side, and which groups are wide depends on how ranks share particles.
template <class T, class F, class... Element>
WEIR_HD inline T sumPacked(std::int64_t i, int count, const PackedLists& lists, const F& f,
                           const Element*... elements) {
  const ListGroup group = lists.groups[i / kListGroup];
  if (group.wide != 0) {
    const int* index = lists.indicesOf(i, group.wide);
    const auto takeIndices = [&](int left, int(&j)[kCodesTogether]) {
      for (int l = 0; l < kCodesTogether; ++l) j[l] = index[(l < left ? l : 0) * kListGroup];
      index += kCodesTogether * kListGroup;
    };
    return sumByFours<T>(count, takeIndices, f, elements...);
  }
  const FourCodes* codes = lists.codesOf(i);
  FourCodes next{};
  if (count > 0) next = *codes;
  const auto takeCodes = [&](int left, int(&j)[kCodesTogether]) {
    next.to(j);
    codes += kListGroup;
    if (left > kCodesTogether) next = *codes;
    for (int l = 0; l < kCodesTogether; ++l) j[l] = group.decode(j[l]);
  };
  return sumByFours<T>(count, takeCodes, f, elements...);
}

/// The list of a particle that a team sums over. Codes are there whatever their number: those of the first
/// two neighbours of each thread are read along with the rest, and both neighbours at once.
struct TeamList {
  static constexpr int kAtOnce = 2;

  const PackedLists& lists;
  TeamIndex at;
  int count;
  ListGroup group;
  int code[kAtOnce];

  WEIR_HD TeamList(const TeamIndex& index, const int* counts, const PackedLists& all)
      : lists(all), at(index) {
    for (int l = 0; l < kAtOnce; ++l) {
      const int k = at.team.lane + l * kSumTeam;
      code[l] = k < lists.capacity ? readAhead(*lists.code(at.i, k)) : 0;
    }
    count = readAhead(counts[at.i]);
    group = readAhead(*lists.groupOf(at.i));
  }
};

/// The same by a team, each of which takes every n-th neighbour. The order depends on the team's size, too.
template <class T, class F, class... Element>
WEIR_HD inline T sumPackedInTeam(const TeamList& list, const F& f, const Element*... elements) {
  constexpr int kAtOnce = TeamList::kAtOnce;
  const PackedLists& lists = list.lists;
  const TeamIndex& at = list.at;
  const ListGroup& group = list.group;
  const int count = list.count;
  T sum{};
  int k = at.team.lane;
  if (group.wide == 0) {
    std::tuple<Element...> rows[kAtOnce];
    for (int l = 0; l < kAtOnce; ++l)
      if (k + l * kSumTeam < count)
        rows[l] = std::tuple<Element...>(loadWhole(elements[group.decode(list.code[l])])...);
    for (int l = 0; l < kAtOnce; ++l, k += kSumTeam)
      if (k < count)
        addTo(sum,
              std::apply([&](const auto&... e) { return f(group.decode(list.code[l]), e...); }, rows[l]));
  }
  const int* index = group.wide == 0 ? nullptr : lists.indicesOf(at.i, group.wide);
  for (; k < count; k += kSumTeam) {
    const int j = index != nullptr ? index[k * kListGroup] : group.decode(*lists.code(at.i, k));
    addTo(sum, f(j, loadWhole(elements[j])...));
  }
  return sumOfTeam(sum);
}

template <class F>
struct CallWithTeamIndex {
  static constexpr bool kInStep = true;
#ifdef __CUDACC__
  static constexpr Standing kLeaves = overlapOf<F>().leaves, kReadsAhead = overlapOf<F>().readsAhead;
#endif
  F f;
  WEIR_HD void operator()(std::int64_t i, const Team& team) const {
    f(TeamIndex{i, team});
  }
};

}  // namespace detail

/// The policy of launches of sums, see Launched: one that follows another sum begins when lists stand, and
/// leaves them as they are.
struct SumAfterSum {
  static constexpr Standing kLeaves = Standing::kLists, kReadsAhead = Standing::kLists;
};
/// For sums that wait for memory so much that more blocks side by side are worth more than more registers.
template <class Policy>
struct ManyBlocks : Policy {
  static constexpr int kBlocksTogether = 6;
};
/// The same for sums that need few registers: as many as a multiprocessor can hold.
template <class Policy>
struct MaxBlocks : Policy {
  static constexpr int kBlocksTogether = 8;
};

/// Calls f(i) for every i in [0, count) as parallelForEights does; or, where few of them leave most of a GPU
/// idle and a thread would wait for each of its neighbours in turn, f(TeamIndex) by teams, which add in
/// another order: where sums must not depend on how many there are, `mayTeam` is false.
template <class Backend, class F>
void parallelForSums(Backend& device, std::string_view name, Count count, const F& f,
                     [[maybe_unused]] bool mayTeam = true) {
  if constexpr (std::is_same_v<Backend, CudaDevice>) {
    constexpr TeamPlan kPlan{kSumTeam, 1 << 15};
    if (mayTeam && count.bound <= kPlan.few)
      return parallelForTeams<kPlan>(device, name, count, detail::CallWithTeamIndex<F>{f});
  }
  parallelForEights(device, name, count, f);
}

}  // namespace weir
