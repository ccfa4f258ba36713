// What solids near particles give to them: the integrals of solid_integrals.h, and the sides from which they
// are seen. On CUDA a team of threads walks down the tree of a solid for each particle; on the CPU the terms
// of pairs of a particle and a triangle are found in lanes.
#pragma once

#include <algorithm>

#include "framework/compute/parallel_uneven.h"
#include "framework/geometry/box_blocks.h"
#include "framework/solids/solid.h"
#include "framework/solids/solid_integrals.h"
#include "framework/solids/triangle_pairs.h"

namespace weir {

/// What one solid gives to one particle.
struct FoundSolid {
  SolidIntegrals<float> integrals;  ///< in the frame of the world
  int sides = 0;                    ///< of SeenSide
};

/// Of the particles near[n], which stand at positions[near[n]].
struct SolidSearch {
  ArrayView<const SolidView> solids;
  float radius;       // m, of the integrals
  float reach;        // m, within which sides are seen; at least the radius
  float calibration;  // of the integrals
  ArrayView<const int> near;
  ArrayView<const Vec3f> positions;
};

namespace detail {

/// What turns its back to a particle outside may be the other side of a thin part.
WEIR_HD inline bool fillsBehind(const SolidView& solid, const FoundSolid& found,
                                const SolidIntegrator<float>& sum) {
  return solid.kind != SolidKind::kSheet && !solid.approximate && (found.sides & kSeesBack) != 0 &&
         sum.isOutside();
}

WEIR_HD inline void finishSolid(const SolidView& solid, const SolidIntegrator<float>& sum, float calibration,
                                FoundSolid& found) {
  found.integrals =
      solid.kind == SolidKind::kSheet ? sum.integralsOfSheet(calibration) : sum.integrals(calibration);
  found.integrals.gradPhi = solid.end.directionToWorld(found.integrals.gradPhi);
}

/// The threads of a team share a walk down the tree.
WEIR_HD inline FoundSolid findSolid(const SolidView& solid, const Vec3f& position, const SolidSearch& search,
                                    const Team& team) {
  const Vec3f p = solid.end.toBody(position);
  if (solid.clearance.at(p) > search.reach) return {};
  SolidIntegrator<float> sum(p, search.radius);
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
    SolidIntegrals<float> sum;
    for (std::int64_t k = 0; k < search.solids.size; ++k) {
      const FoundSolid found = findSolid(search.solids[k], search.positions[i], search, team);
      if (team.lane == 0) take(i, k, found);
      sum += found.integrals;
    }
    if (team.lane == 0) take(i, sum);
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

  void together(std::int64_t begin, std::int64_t end, TrianglePairs& pairs) const {
    SolidIntegrals<float> sums[TrianglePairs::kMaxParticles];
    for (std::int64_t k = 0; k < search.solids.size; ++k)
      for (std::int64_t n = begin; n < end;) n = some(k, n, end, pairs, sums + (n - begin));
    for (std::int64_t n = begin; n < end; ++n) take(search.near[n], sums[n - begin]);
  }

  /// Of solid k and as many particles as pairs have room for. Returns where the next begin.
  std::int64_t some(std::int64_t k, std::int64_t begin, std::int64_t end, TrianglePairs& pairs,
                    SolidIntegrals<float>* sums) const {
    const SolidView& solid = search.solids[k];
    int triangles[kMaxTriangles + Lanes::kCount];
    Vec3f points[TrianglePairs::kMaxParticles];
    bool alone[TrianglePairs::kMaxParticles];
    pairs.clear();
    std::int64_t n = begin;
    for (; n < end; ++n) {
      const Vec3f p = points[n - begin] = solid.end.toBody(search.positions[search.near[n]]);
      int count = 0;
      if (!(solid.clearance.at(p) > search.reach))
        count = solid.tree.empty() ? 0 : solid.tree.blocks->near(p, search.reach, triangles, kMaxTriangles);
      alone[n - begin] = count > kMaxTriangles || solid.approximate;
      if (alone[n - begin]) count = 0;
      if (!pairs.hasRoom(count)) break;
      pairs.add(p, triangles, count);
    }
    pairs.evaluate(solid.tree, solid.kind == SolidKind::kContainer, search.radius);
    for (std::int64_t m = begin; m < n; ++m) {
      const int i = search.near[m];
      const FoundSolid found = alone[m - begin] ? findSolid(solid, search.positions[i], search, Team{})
                                                : foundBy(solid, points[m - begin], pairs, int(m - begin));
      take(i, k, found);
      sums[m - begin] += found.integrals;
    }
    return n;
  }

  FoundSolid foundBy(const SolidView& solid, const Vec3f& p, const TrianglePairs& pairs, int particle) const {
    SolidIntegrator<float> sum(p, search.radius);
    FoundSolid found{.integrals = {}, .sides = pairs.sidesSeen(particle)};
    pairs.forEachTriangle(particle, [&](const TriangleTerms<float>& terms) { sum.add(terms); });
    if (fillsBehind(solid, found, sum))
      pairs.forEachTriangle(particle, [&](const TriangleTerms<float>& terms) { sum.fillBehind(terms); });
    finishSolid(solid, sum, search.calibration, found);
    return found;
  }
};

#endif

}  // namespace detail

/// Calls take(i, k, FoundSolid) for every particle i of the search and each solid k in order, and take(i,
/// sum) with the SolidIntegrals of all. There are `count` particles.
template <class Backend, class Take>
void findSolids(Backend& device, std::string_view name, Count count, const SolidSearch& search,
                const Take& take) {
  // Few particles are near solids, and each has many triangles.
  constexpr TeamPlan kPlan{32, 1 << 17};
#ifdef WEIR_HAS_LANES
  if constexpr (!std::is_same_v<Backend, CudaDevice>)
    return forEachUnevenRange(device, name, count, detail::FindSolidsInLanes<Take>{search, take});
#endif
  parallelForUneven<kPlan>(device, name, count, detail::FindSolids<Take>{search, take});
}

}  // namespace weir
