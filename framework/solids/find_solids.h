// What solids near particles give to them: the integrals of solid_integrals.h, and the sides from which they
// are seen. On CUDA a team of threads walks down the tree of a solid for each particle; on the CPU the terms
// of pairs of a particle and a triangle are found in lanes.
#pragma once

#include <algorithm>
#include <limits>

#include "framework/compute/parallel_uneven.h"
#include "framework/geometry/box_blocks.h"
#include "framework/solids/solid.h"
#include "framework/solids/solid_integrals.h"
#include "framework/solids/solid_pairs.h"
#include "framework/solids/triangle_pairs.h"

namespace weir {

/// What one solid gives to one particle.
struct FoundSolid {
  SolidIntegrals<float> integrals;  ///< in the frame of the world
  SymmetricTensor curvature;        ///< about ∇∇Φ there, (7) of solid_integrals.h
  int sides = 0;                    ///< of SeenSide

  WEIR_HD FoundSolid& operator+=(const FoundSolid& other) {
    integrals += other.integrals;
    curvature += other.curvature;
    sides |= other.sides;
    return *this;
  }
};

/// Of the particles near[n], which stand at positions[near[n]].
struct SolidSearch {
  ArrayView<const SolidView> solids;
  float radius;       // m, of the integrals
  float reach;        // m, within which sides are seen; at least the radius
  float calibration;  // of the integrals
  ArrayView<const int> near;
  SolidPairsView pairs;
  ArrayView<const Vec3f> positions;
};

namespace detail {

/// What turns its back to a particle outside may be the other side of a thin part.
WEIR_HD inline bool fillsBehind(const SolidView& solid, const FoundSolid& found,
                                const SolidIntegrator<float>& sum) {
  return solid.kind != SolidKind::kSheet && !solid.approximate && (found.sides & kSeesBack) != 0 &&
         sum.isOutside();
}

WEIR_HD inline SymmetricTensor toWorld(const Pose& pose, const SymmetricTensor& k) {
  // R·K, by its columns, and of that the rows times Rᵀ.
  const Vec3f x = pose.directionToWorld({k.diagonal.x, k.off.x, k.off.y}),
              y = pose.directionToWorld({k.off.x, k.diagonal.y, k.off.z}),
              z = pose.directionToWorld({k.off.y, k.off.z, k.diagonal.z});
  const Vec3f first = pose.directionToWorld({x.x, y.x, z.x}), second = pose.directionToWorld({x.y, y.y, z.y}),
              third = pose.directionToWorld({x.z, y.z, z.z});
  return {{first.x, second.y, third.z}, {first.y, first.z, second.z}};
}

WEIR_HD inline void finishSolid(const SolidView& solid, const SolidIntegrator<float>& sum, float calibration,
                                FoundSolid& found) {
  found.integrals =
      solid.kind == SolidKind::kSheet ? sum.integralsOfSheet(calibration) : sum.integrals(calibration);
  found.integrals.gradPhi = solid.end.directionToWorld(found.integrals.gradPhi);
  found.curvature = toWorld(solid.end, sum.curvature(calibration));
}

/// The threads of a team share a walk down the tree.
WEIR_HD inline FoundSolid findSolid(const SolidView& solid, const Vec3f& position, const SolidSearch& search,
                                    const Team& team) {
  const Vec3f p = solid.end.toBody(position);
  SolidIntegrator<float> sum(p, search.radius, solid.kind == SolidKind::kSheet);
  FoundSolid found;
  const auto forEachNear = [&](float within, auto&& f) {
    const bool container = solid.kind == SolidKind::kContainer;
    solid.tree.forEachTriangleNear(
        p, within,
        [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) { f(a, container ? c : b, container ? b : c); },
        team);
  };
  forEachNear(search.reach, [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    found.sides |= sidesSeen(p, a, b, c);
    if (solid.approximate)
      sum.addTriangleApproximately(a, b, c);
    else
      sum.addTriangle(a, b, c);
  });
  sum.unite(team);
  found.sides = team.unite(found.sides);
  if (fillsBehind(solid, found, sum)) {
    forEachNear(search.radius,
                [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) { sum.fillBehind(a, b, c); });
    sum.uniteBehind(team);
  }
  finishSolid(solid, sum, search.calibration, found);
  return found;
}

/// The n-th particle, by a team.
template <class Take>
struct FindSolids {
  SolidSearch search;
  Take take;

  WEIR_HD void operator()(std::int64_t n, const Team& team) const {
    const int i = search.near[n];
    FoundSolid sum;
    for (int pair = search.pairs.begin(i); pair < search.pairs.end(i); ++pair) {
      const SolidView& solid = search.solids[search.pairs.solid[pair]];
      const FoundSolid found = findSolid(solid, search.positions[i], search, team);
      if (team.lane == 0) take(pair, found);
      sum += found;
    }
    if (team.lane == 0) take.all(i, sum);
  }
};

#ifdef WEIR_HAS_LANES

/// The same for ranges of near particles, which fill lanes together.
template <class Take>
struct FindSolidsInLanes {
  SolidSearch search;
  Take take;

  void operator()(std::int64_t begin, std::int64_t end) const {
    TrianglePairs pairs;
    for (std::int64_t n = begin; n < end; n += TrianglePairs::kMaxParticles)
      together(n, std::min<std::int64_t>(n + TrianglePairs::kMaxParticles, end), pairs);
  }

 private:
  static constexpr int kMaxTriangles = TrianglePairs::kMax;  // of a particle
  static constexpr int kNone = std::numeric_limits<int>::max();

  struct Progress {
    int next, end;  // of its pairs
    FoundSolid sum;
  };

  void together(std::int64_t begin, std::int64_t end, TrianglePairs& pairs) const {
    Progress of[TrianglePairs::kMaxParticles];
    for (std::int64_t n = begin; n < end; ++n) {
      const int i = search.near[n];
      of[n - begin] = {.next = search.pairs.begin(i), .end = search.pairs.end(i), .sum = {}};
    }
    for (int k = nextSolid(of, end - begin); k != kNone; k = nextSolid(of, end - begin))
      for (std::int64_t n = begin; n < end;) n = some(k, n, end, pairs, of + (n - begin));
    for (std::int64_t n = begin; n < end; ++n) take.all(search.near[n], of[n - begin].sum);
  }

  /// The first solid of those that the particles still have before them.
  int nextSolid(const Progress* of, std::int64_t particles) const {
    int first = kNone;
    for (std::int64_t m = 0; m < particles; ++m)
      if (of[m].next < of[m].end) first = std::min(first, search.pairs.solid[of[m].next]);
    return first;
  }
  bool isNext(int k, const Progress& of) const {
    return of.next < of.end && search.pairs.solid[of.next] == k;
  }

  /// Of solid k and as many particles as pairs have room for. Returns where the next begin.
  std::int64_t some(int k, std::int64_t begin, std::int64_t end, TrianglePairs& pairs, Progress* of) const {
    const SolidView& solid = search.solids[k];
    int triangles[kMaxTriangles + Lanes::kCount];
    Vec3f points[TrianglePairs::kMaxParticles];
    bool alone[TrianglePairs::kMaxParticles];
    pairs.clear();
    std::int64_t n = begin;
    for (; n < end; ++n) {
      const Vec3f p = points[n - begin] = solid.end.toBody(search.positions[search.near[n]]);
      int count = 0;
      if (isNext(k, of[n - begin]))
        count = solid.tree.empty() ? 0 : solid.tree.blocks->near(p, search.reach, triangles, kMaxTriangles);
      alone[n - begin] = count > kMaxTriangles || solid.approximate;
      if (alone[n - begin]) count = 0;
      if (!pairs.hasRoom(count)) break;
      pairs.add(p, triangles, count);
    }
    pairs.evaluate(solid.tree, solid.kind == SolidKind::kContainer, search.radius);
    for (std::int64_t m = begin; m < n; ++m) {
      Progress& particle = of[m - begin];
      if (!isNext(k, particle)) continue;
      const Vec3f& position = search.positions[search.near[m]];
      const FoundSolid found = alone[m - begin] ? findSolid(solid, position, search, Team{})
                                                : foundBy(solid, points[m - begin], pairs, int(m - begin));
      take(particle.next++, found);
      particle.sum += found;
    }
    return n;
  }

  FoundSolid foundBy(const SolidView& solid, const Vec3f& p, const TrianglePairs& pairs, int particle) const {
    SolidIntegrator<float> sum(p, search.radius, solid.kind == SolidKind::kSheet);
    FoundSolid found{.sides = pairs.sidesSeen(particle)};
    pairs.forEachTriangle(particle, [&](const TriangleTerms<float>& terms) { sum.add(terms); });
    if (fillsBehind(solid, found, sum))
      pairs.forEachTriangle(particle, [&](const TriangleTerms<float>& terms) { sum.fillBehind(terms); });
    finishSolid(solid, sum, search.calibration, found);
    return found;
  }
};

#endif

}  // namespace detail

/// Calls take(pair, FoundSolid) for every pair of the particles near[n], in the order of their solids, and
/// take.all(i, sum) with what all of them give to particle i. There are `count` particles. Where their bits
/// must not depend on how many there are, `alwaysTeams` is true.
template <class Backend, class Take>
void findSolids(Backend& device, std::string_view name, Count count, const SolidSearch& search,
                const Take& take, [[maybe_unused]] bool alwaysTeams = false) {
  // Few particles are near solids, and each has many triangles.
  constexpr TeamPlan kPlan{32, 1 << 17}, kAlways{32, std::numeric_limits<std::int64_t>::max()};
#ifdef WEIR_HAS_LANES
  if constexpr (!std::is_same_v<Backend, CudaDevice>)
    return forEachUnevenRange(device, name, count, detail::FindSolidsInLanes<Take>{search, take});
#endif
  if (alwaysTeams)
    parallelForUneven<kAlways>(device, name, count, detail::FindSolids<Take>{search, take});
  else
    parallelForUneven<kPlan>(device, name, count, detail::FindSolids<Take>{search, take});
}

}  // namespace weir
