#include "nodes/particle_fluid/modules/wall_integrals.h"

#include <vector>

#include "framework/compute/parallel_uneven.h"
#include "nodes/geometry/box_blocks.h"
#include "nodes/particle_fluid/hidden_neighbors.h"
#include "nodes/solids/solid_integrals.h"

namespace weir {

namespace {

struct Found {
  SolidIntegrals<float> integrals;  ///< in the frame of the world
  int sides = 0;
};

/// `reach` is the support of the fluid, at least the radius of the integrals. `triangles` has the solid's
/// forEachTriangleNear.
template <class Triangles>
WEIR_HD Found findOf(const SolidView& solid, const Triangles& triangles, const Vec3f& position, float radius,
                     float reach, float calibration, const Team& team) {
  const Vec3f p = solid.end.toBody(position);
  if (solid.clearance.at(p) > reach) return {};
  SolidIntegrator<float> sum(p, radius);
  Found found;
  const auto forEachNear = [&](float within, auto&& f) {
    const bool container = solid.kind == SolidKind::kContainer;
    triangles.forEachTriangleNear(solid.tree, p, within, [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) {
      f(a, container ? c : b, container ? b : c);
    });
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
  const bool sheet = solid.kind == SolidKind::kSheet;
  // What turns its back to a particle outside may be the other side of a thin part.
  if (!sheet && !solid.approximate && (found.sides & kSeesBack) != 0 && sum.isOutside()) {
    forEachNear(radius, [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) { sum.fillBehind(a, b, c); });
    sum.uniteBehind(team);
  }
  found.integrals = sheet ? sum.integralsOfSheet(calibration) : sum.integrals(calibration);
  found.integrals.gradPhi = solid.end.directionToWorld(found.integrals.gradPhi);
  return found;
}

/// The threads of a team share a walk down the tree.
struct WalkInTeam {
  const Team& team;

  template <class F>
  WEIR_HD void forEachTriangleNear(const TriangleTreeView& tree, const Vec3f& p, float radius, F&& f) const {
    tree.forEachTriangleNear(p, radius, f, team);
  }
};

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
    find(n, team, [&team](std::int64_t) { return WalkInTeam{team}; });
  }

  /// `trianglesOf(k)` are those of solid k.
  template <class TrianglesOf>
  WEIR_HD void find(std::int64_t n, const Team& team, const TrianglesOf& trianglesOf) const {
    const int i = near[n];
    const Vec3f p = positions[i];
    Vec3f gradient{};
    float phi = 0, sumOfD = 0;
    for (std::int64_t k = 0; k < solids.size; ++k) {
      const Found found = findOf(solids[k], trianglesOf(k), p, radius, reach, calibration, team);
      const SolidIntegrals<float>& of = found.integrals;
      if (team.lane == 0) {
        sides[k * stride + i] = found.sides;
        each[k * stride + i] = {of.gradPhi.x, of.gradPhi.y, of.gradPhi.z, of.phi};
      }
      gradient += of.gradPhi;
      phi += of.phi;
      sumOfD += of.d;
    }
    if (team.lane != 0) return;
    if (total.size > 0) total[i] = {gradient.x, gradient.y, gradient.z, phi};
    d[i] = sumOfD;
  }
};

#ifdef WEIR_HAS_LANES

struct FindIntegralsByBlocks {
  FindIntegrals find;
  const BoxBlocks* blocks;  // of the solids

  void operator()(std::int64_t n) const {
    find.find(n, {}, [this](std::int64_t k) -> const BoxBlocks& { return blocks[k]; });
  }
};

#endif

}  // namespace

template <class Backend>
void WallIntegrals::findOn(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  walls.fit(fluid.particles);
  const bool several = walls.solids.size() > 1;
  walls.keepLegal(fluid.particles.positions());
  walls.base = {};
  const ArrayView<const SolidView> solids = walls.views.view();
  const ArrayView<const Vec3f> positions = std::as_const(fluid.particles).positions().view();
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
#ifdef WEIR_HAS_LANES
  if constexpr (!std::is_same_v<Backend, CudaDevice>) {
    std::vector<BoxBlocks> blocks;
    for (std::int64_t k = 0; k < solids.size; ++k) blocks.emplace_back(device, solids[k].tree);
    parallelForUneven(device, kName, walls.nearCount(), FindIntegralsByBlocks{find, blocks.data()});
    takeOutHiddenNeighbors(device, fluid);
    return;
  }
#endif
  constexpr TeamPlan kPlan{32, 1 << 17};
  parallelForTeams(device, kName, walls.nearCount(), kPlan, find);
  takeOutHiddenNeighbors(device, fluid);
}

template void WallIntegrals::findOn(ThisBackend&, FluidStep&);

}  // namespace weir
