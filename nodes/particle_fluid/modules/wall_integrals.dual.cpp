#include "nodes/particle_fluid/modules/wall_integrals.h"

#include <algorithm>

#include "framework/compute/parallel_uneven.h"
#include "framework/geometry/box_blocks.h"
#include "framework/solids/solid_integrals.h"
#include "framework/solids/triangle_pairs.h"
#include "nodes/particle_fluid/hidden_neighbors.h"

namespace weir {

namespace {

struct Found {
  SolidIntegrals<float> integrals;  ///< in the frame of the world
  int sides = 0;
};

/// What turns its back to a particle outside may be the other side of a thin part.
WEIR_HD bool fillsBehind(const SolidView& solid, const Found& found, const SolidIntegrator<float>& sum) {
  return solid.kind != SolidKind::kSheet && !solid.approximate && (found.sides & kSeesBack) != 0 &&
         sum.isOutside();
}

WEIR_HD void take(const SolidView& solid, const SolidIntegrator<float>& sum, float calibration,
                  Found& found) {
  found.integrals =
      solid.kind == SolidKind::kSheet ? sum.integralsOfSheet(calibration) : sum.integrals(calibration);
  found.integrals.gradPhi = solid.end.directionToWorld(found.integrals.gradPhi);
}

/// `reach` is the support of the fluid, at least the radius of the integrals. The threads of a team share a
/// walk down the tree.
WEIR_HD Found findOf(const SolidView& solid, const Vec3f& position, float radius, float reach,
                     float calibration, const Team& team) {
  const Vec3f p = solid.end.toBody(position);
  if (solid.clearance.at(p) > reach) return {};
  SolidIntegrator<float> sum(p, radius);
  Found found;
  const auto forEachNear = [&](float within, auto&& f) {
    const bool container = solid.kind == SolidKind::kContainer;
    solid.tree.forEachTriangleNear(
        p, within,
        [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) { f(a, container ? c : b, container ? b : c); },
        team);
  };
  forEachNear(reach, [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    found.sides |= sidesSeen(p, a, b, c);
    if (solid.approximate)
      sum.addTriangleApproximately(a, b, c);
    else
      sum.addTriangle(a, b, c);
  });
  sum.unite(team);
  found.sides = team.unite(found.sides);
  if (fillsBehind(solid, found, sum)) {
    forEachNear(radius, [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) { sum.fillBehind(a, b, c); });
    sum.uniteBehind(team);
  }
  take(solid, sum, calibration, found);
  return found;
}

struct IsNear {
  ArrayView<const SolidView> solids;
  float reach;
  ArrayView<const Vec3f> positions;

  WEIR_HD bool operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    for (std::int64_t k = 0; k < solids.size; ++k)
      if (!(solids[k].clearance.at(solids[k].end.toBody(p)) > reach)) return true;
    return false;
  }
};

struct FindIntegrals {
  ArrayView<const SolidView> solids;
  float radius, reach, calibration;
  std::int64_t stride;
  ArrayView<const int> near;
  ArrayView<const Vec3f> positions;
  ArrayView<Vec4f> each, total;  // total is empty where there is one solid
  ArrayView<float> d;
  ArrayView<int> sides;

  WEIR_HD void operator()(std::int64_t n, const Team& team) const {
    const int i = near[n];
    SolidIntegrals<float> sum;
    for (std::int64_t k = 0; k < solids.size; ++k) {
      const Found found = findOf(solids[k], positions[i], radius, reach, calibration, team);
      if (team.lane == 0) write(i, k, found);
      add(found.integrals, sum);
    }
    if (team.lane == 0) writeSum(i, sum);
  }

  WEIR_HD void write(int i, std::int64_t k, const Found& found) const {
    const SolidIntegrals<float>& of = found.integrals;
    sides[k * stride + i] = found.sides;
    each[k * stride + i] = {of.gradPhi.x, of.gradPhi.y, of.gradPhi.z, of.phi};
  }
  WEIR_HD void writeSum(int i, const SolidIntegrals<float>& sum) const {
    if (total.size > 0) total[i] = {sum.gradPhi.x, sum.gradPhi.y, sum.gradPhi.z, sum.phi};
    d[i] = sum.d;
  }
  WEIR_HD static void add(const SolidIntegrals<float>& of, SolidIntegrals<float>& sum) {
    sum.gradPhi += of.gradPhi;
    sum.phi += of.phi;
    sum.d += of.d;
  }
};

#ifdef WEIR_HAS_LANES

/// The same for ranges of near particles, which fill lanes together.
struct FindIntegralsInLanes {
  FindIntegrals find;

  void operator()(std::int64_t begin, std::int64_t end) const {
    TrianglePairs pairs;
    for (std::int64_t n = begin; n < end; n += TrianglePairs::kMaxParticles)
      together(n, std::min<std::int64_t>(n + TrianglePairs::kMaxParticles, end), pairs);
  }

 private:
  static constexpr int kMaxTriangles = TrianglePairs::kMax;  // of a particle

  void together(std::int64_t begin, std::int64_t end, TrianglePairs& pairs) const {
    SolidIntegrals<float> sums[TrianglePairs::kMaxParticles];
    for (std::int64_t k = 0; k < find.solids.size; ++k)
      for (std::int64_t n = begin; n < end;) n = some(k, n, end, pairs, sums + (n - begin));
    for (std::int64_t n = begin; n < end; ++n) find.writeSum(find.near[n], sums[n - begin]);
  }

  /// Of solid k and as many particles as pairs have room for. Returns where the next begin.
  std::int64_t some(std::int64_t k, std::int64_t begin, std::int64_t end, TrianglePairs& pairs,
                    SolidIntegrals<float>* sums) const {
    const SolidView& solid = find.solids[k];
    int triangles[kMaxTriangles + Lanes::kCount];
    Vec3f points[TrianglePairs::kMaxParticles];
    bool alone[TrianglePairs::kMaxParticles];
    pairs.clear();
    std::int64_t n = begin;
    for (; n < end; ++n) {
      const Vec3f p = points[n - begin] = solid.end.toBody(find.positions[find.near[n]]);
      int count = 0;
      if (!(solid.clearance.at(p) > find.reach))
        count = solid.tree.empty() ? 0 : solid.tree.blocks->near(p, find.reach, triangles, kMaxTriangles);
      alone[n - begin] = count > kMaxTriangles || solid.approximate;
      if (alone[n - begin]) count = 0;
      if (!pairs.hasRoom(count)) break;
      pairs.add(p, triangles, count);
    }
    pairs.evaluate(solid.tree, solid.kind == SolidKind::kContainer, find.radius);
    for (std::int64_t m = begin; m < n; ++m) {
      const int i = find.near[m];
      const Found found = alone[m - begin] ? findOf(solid, find.positions[i], find.radius, find.reach,
                                                    find.calibration, Team{})
                                           : foundBy(solid, points[m - begin], pairs, int(m - begin));
      find.write(i, k, found);
      find.add(found.integrals, sums[m - begin]);
    }
    return n;
  }

  Found foundBy(const SolidView& solid, const Vec3f& p, const TrianglePairs& pairs, int particle) const {
    SolidIntegrator<float> sum(p, find.radius);
    Found found{.integrals = {}, .sides = pairs.sidesSeen(particle)};
    pairs.forEachTriangle(particle, [&](const TriangleTerms<float>& terms) { sum.add(terms); });
    if (fillsBehind(solid, found, sum))
      pairs.forEachTriangle(particle, [&](const TriangleTerms<float>& terms) { sum.fillBehind(terms); });
    take(solid, sum, find.calibration, found);
    return found;
  }
};

#endif

}  // namespace

template <class Backend>
void WallIntegrals::findOn(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  walls.fit(fluid.particles);
  const bool several = walls.solids.size() > 1;
  walls.keepLegal(fluid.particles.positions().read());
  walls.base = {};
  const ArrayView<const SolidView> solids = walls.views.view();
  const ArrayView<const Vec3f> positions = fluid.particles.positions().read();
  const float reach = fluid.constants.supportRadius;
  walls.list(device, "near solids", fluid.particles.count(), IsNear{solids, reach, positions}, walls.near,
             walls.nearCounter);
  // All others feel nothing and see nothing.
  walls.each.fillZero();
  if (several) walls.total.fillZero();
  walls.d.fillZero();
  walls.sides.fillZero();
  // Few of these are near walls, and each has many triangles.
  constexpr std::string_view kName = "wall integrals";
  const FindIntegrals find{solids,
                           fluid.constants.wallRadius,
                           reach,
                           fluid.constants.wallFactor,
                           walls.stride,
                           std::as_const(walls.near).view(),
                           positions,
                           walls.each.view(),
                           several ? walls.total.view() : ArrayView<Vec4f>{},
                           walls.d.view(),
                           walls.sides.view()};
  constexpr TeamPlan kPlan{32, 1 << 17};
#ifdef WEIR_HAS_LANES
  if constexpr (!std::is_same_v<Backend, CudaDevice>)
    forEachUnevenRange(device, kName, walls.nearCount(), FindIntegralsInLanes{find});
  else
#endif
    parallelForUneven<kPlan>(device, kName, walls.nearCount(), find);
  takeOutHiddenNeighbors(device, fluid);
}

template void WallIntegrals::findOn(ThisBackend&, FluidStep&);

}  // namespace weir
