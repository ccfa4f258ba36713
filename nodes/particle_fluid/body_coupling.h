// How a fluid moves bodies, strongly: within the iterations of its solver, and where particles hit them.
//
// The objective of pressure_problem.h gains ½·qᵀ·(M/m)·q for each body, q being the six components of its
// displacement from where gravity alone brings it, M its mass and inertia, m the mass of a particle; and Φ_i
// loses g_i·J_i·q, where g_i = ∇Φ_i and J_i·q is the way of the body's point at particle i. At the least
// objective the body has got what the fluid has given: (M/m)·q = −Σ J_iᵀ·g_i·s_i with the shares s of the
// walls in the particles' displacements (wall_field.h). An iteration keeps that exact. The plain update has
// brought the shares to s'; by w_i = (c·dt)²·|Ḃ⁻|/divisor_i each follows Φ_i. So with
//
//   (M/m + Σ w_i·J_iᵀ·g_i·g_iᵀ·J_i)·δ = −(Σ J_iᵀ·g_i·s'_i + (M/m)·q)
//   q ← q + δ,   s_i ← s'_i + w_i·g_i·J_i·δ
//
// the body's mobility enters the divisors of all particles at once (Woodbury): where the plain iteration is
// stable beside walls at rest, this one is beside bodies of any mass, those of none included. What the fluid
// loses the body gets, in every iteration. Where a particle is near several bodies, its w counts once for
// each of them, which bounds what they do to each other.
//
// A particle that is stopped by a body, by Δv along e, takes the velocity that the body has after all hits of
// the stage: (M + Σ m·J_iᵀ·e_i·e_iᵀ·J_i)·δv = −Σ m·J_iᵀ·Δv_i, Δv_i ← Δv_i + e_i·e_iᵀ·J_i·δv.
#pragma once

#include "framework/compute/parallel_uneven.h"
#include "framework/compute/reduce_by_key.h"
#include "nodes/particle_fluid/fluid_sums.h"
#include "nodes/particle_fluid/pressure_problem.h"
#include "nodes/particle_fluid/solver_sums.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

/// Brings bodies that forces move to where they are: at the beginning of a step of `dt` s, and to where
/// gravity (m/s²) brings them; with dt = 0, where they stand. The other views stay as they are. Then sorts
/// the grid of the solids.
void placeBodies(WallField& walls, const Vec3f& gravity, double dt);

namespace detail {

/// The bodies near particles.
struct NearBodies {
  ArrayView<const SolidView> solids;
  SolidPairsView pairs;
  ArrayView<const Vec3f> foundAt;  // see WallFieldView
  ArrayView<const Vec4f> each;

  /// Calls f(k, body, g_i, arm) for each body k near particle i.
  template <class F>
  WEIR_HD void forEach(int i, const F& f) const {
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) {
      const int k = pairs.solid[pair];
      const FreeBody* body = solids[k].body;
      if (body == nullptr) continue;
      const Vec3f p = foundAt[i];
      f(k, *body, doubleOf(xyz(each[pair])), doubleOf(p) - (body->predicted.center + body->searched.linear));
    }
  }
};

struct SumPushes {
  NearBodies bodies;
  ArrayView<const int> near;
  ArrayView<const float> share, grip;  // no grip: none follows

  template <class Give>
  WEIR_HD void operator()(std::int64_t n, const Give& give) const {
    const int i = near[n];
    const double s = share[i], w = grip.size > 0 ? grip[i] : 0.0f;
    if (s == 0 && w == 0) return;
    int count = 0;
    bodies.forEach(i, [&](int, const FreeBody&, const Vec3d&, const Vec3d&) { ++count; });
    bodies.forEach(i, [&](int k, const FreeBody&, const Vec3d& g, const Vec3d& arm) {
      give(k, [&] {
        BodySums sums;
        sums.add(g, arm, s, count * w);
        return sums;
      });
    });
  }
};

struct MoveBodies {
  ArrayView<const SolidView> solids;
  const BodySums* sums;
  double particleMass;
  const int* done;  // null where nobody knows

  WEIR_HD void operator()(std::int64_t k) const {
    FreeBody* body = solids[k].body;
    if (body == nullptr) return;
    body->change = {};
    if (done != nullptr && *done) return;
    TwistMatrix mass = body->mass.matrix(body->predicted.rotation);
    for (double& number : mass.of) number /= particleMass;
    const Twist held = product(mass, body->displacement);
    sums[k].addGripTo(mass);
    body->change = solved(mass, -1.0 * (sums[k].push - -1.0 * held), body->mass.locked);
    body->displacement += body->change;
  }
};

/// What the bodies' displacements do to the particles near them.
struct FollowBodies {
  NearBodies bodies;
  WallFieldView walls;
  ArrayView<const int> near;
  bool shares;  // whether particles follow, too
  ArrayView<float> lift;
  ArrayView<Vec3f> displacement;
  ArrayView<Vec4f> state;
  const int* done;

  WEIR_HD void operator()(std::int64_t n) const {
    if (done != nullptr && *done) return;
    const int i = near[n];
    double all = 0, change = 0;
    bodies.forEach(i, [&](int, const FreeBody& body, const Vec3d& g, const Vec3d& arm) {
      all += dot(g, (body.displacement - body.searched).at(arm));
      change += dot(g, body.change.at(arm));
    });
    lift[i] = float(all);
    const float more = shares ? float(double(walls.grip[i]) * change) : 0.0f;
    if (more == 0) return;
    const Vec4f at = state[i];
    const Vec3f u = more * walls.sharedGradient(i, xyz(at));
    walls.share[i] += more;
    displacement[i] += u;
    state[i] = {at.x + u.x, at.y + u.y, at.z + u.z, at.w};
  }
};

struct AddBodyEnergy {
  ArrayView<const SolidView> solids;
  double particleMass;
  SolverSums* sums;

  WEIR_HD void operator()(std::int64_t) const {
    for (std::int64_t k = 0; k < solids.size; ++k) {
      const FreeBody* body = solids[k].body;
      if (body == nullptr) continue;
      const Twist q = body->displacement, p = product(body->mass.matrix(body->predicted.rotation), q);
      sums->objective += 0.5 * (dot(q.linear, p.linear) + dot(q.angular, p.angular)) / particleMass;
    }
  }
};

/// To where the solver has brought them, so that solids near particles are found there.
struct SearchAtBodies {
  ArrayView<SolidView> solids;

  WEIR_HD void operator()(std::int64_t k) const {
    SolidView& solid = solids[k];
    if (solid.body == nullptr) return;
    FreeBody& body = *solid.body;
    body.searched = body.displacement;
    const BodyState at = body.predicted.moved(body.displacement);
    solid.end = poseOf(body.mass, at);
    solid.pivot = floatOf(at.center);
  }
};

struct EndBodies {
  ArrayView<SolidView> solids;
  double inverseDt;

  WEIR_HD void operator()(std::int64_t k) const {
    SearchAtBodies{solids}(k);
    if (FreeBody* body = solids[k].body) body->motion += inverseDt * body->displacement;
  }
};

/// A hit, from kick[m].
struct Hit {
  int solid = -1;
  Vec3d direction, arm;
  double change = 0;  // m/s, along the direction

  WEIR_HD static Hit of(const Vec4f& kick, const Vec3f& position, ArrayView<const SolidView> solids) {
    const int k = static_cast<int>(kick.w);
    if (k < 0 || solids[k].body == nullptr) return {};
    const Vec3d dv = doubleOf(xyz(kick));
    const double size = length(dv);
    if (!(size > 0)) return {};
    return {k, dv / size, doubleOf(position - solids[k].pivot), size};
  }
};

struct SumHits {
  ArrayView<const SolidView> solids;
  double mass;
  ArrayView<const int> met;
  ArrayView<const Vec3f> positions;
  ArrayView<const Vec4f> kick;

  template <class Give>
  WEIR_HD void operator()(std::int64_t m, const Give& give) const {
    const Hit hit = Hit::of(kick[m], positions[met[m]], solids);
    if (hit.solid < 0) return;
    give(hit.solid, [&] {
      BodySums sums;
      sums.add(hit.direction, hit.arm, mass * hit.change, mass);
      return sums;
    });
  }
};

struct HitBodies {
  ArrayView<const SolidView> solids;
  const BodySums* sums;

  WEIR_HD void operator()(std::int64_t k) const {
    FreeBody* body = solids[k].body;
    if (body == nullptr) return;
    TwistMatrix mass = body->mass.matrix(body->predicted.rotation);
    sums[k].addGripTo(mass);
    body->change = solved(mass, -1.0 * sums[k].push, body->mass.locked);
    body->motion += body->change;
  }
};

struct FollowHits {
  ArrayView<const SolidView> solids;
  ArrayView<const int> met;
  ArrayView<const Vec3f> positions;
  ArrayView<Vec3f> velocities;
  ArrayView<Vec4f> kick;

  WEIR_HD void operator()(std::int64_t m) const {
    const int i = met[m];
    const Hit hit = Hit::of(kick[m], positions[i], solids);
    if (hit.solid < 0) return;
    const double along = dot(hit.direction, solids[hit.solid].body->change.at(hit.arm));
    const Vec3f change = floatOf(along * hit.direction);
    velocities[i] += change;
    kick[m] = {kick[m].x + change.x, kick[m].y + change.y, kick[m].z + change.z, kick[m].w};
  }
};

/// Six numbers of what f gives, as there is no room on a GPU to add all of them exactly at once.
template <class F>
struct PartOfBodySums {
  F f;
  int part;

  template <class Give>
  WEIR_HD void operator()(std::int64_t i, const Give& give) const {
    f(i, [&](int key, const auto& make) { give(key, [&] { return make().part(part); }); });
  }
};

struct AddTwists {
  WEIR_HD Twist operator()(Twist a, const Twist& b) const { return a += b; }
};

/// Sums what f gives into walls.bodySums, over all ranks; `lists` as those of OnAllRanks.
template <class Backend, class F>
void sumBodies(Backend& device, const char* name, FluidStep& fluid, Count count, const KeyListsView& lists,
               const F& f) {
  WallField& walls = fluid.walls;
  const std::int64_t keys = walls.views.size();
  Communicator* const ranks = ranksOf(fluid);
  if (ranks == nullptr)
    return reduceByKeyOrList(device, name, {nullptr, count, lists}, keys, BodySums{}, f, AddBodySums{},
                             walls.bodySums.data());
  std::vector<BodySums> sums(static_cast<std::size_t>(keys));
  Array<Twist> found(fluid.device, keys);
  for (int part = 0; part < BodySums::kParts; ++part) {
    sumByKeyOverRanks(device, name, {ranks, count, lists}, keys, PartOfBodySums<F>{f, part}, AddTwists{},
                      found.data());
    const std::vector<Twist> values = found.toHost();
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k].setPart(part, values[k]);
  }
  walls.bodySums.assign(sums);
}

template <class Backend>
NearBodies nearBodies(Backend&, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  return {.solids = std::as_const(walls.views).view(),
          .pairs = walls.pairs.view(),
          .foundAt = std::as_const(walls.foundAt).view(),
          .each = std::as_const(walls.each).view()};
}

}  // namespace detail

/// Moves bodies by what the pressure has come to, unless *done. If `yields`, after an iteration, the
/// particles at them give way to that; otherwise shares are some combination of earlier ones, and the bodies'
/// follow exactly.
template <class Backend>
void moveBodies(Backend& device, const PressureProblem& problem, bool yields, const int* done = nullptr) {
  FluidStep& fluid = problem.fluid;
  WallField& walls = fluid.walls;
  if (!walls.moves) return;
  walls.moved = true;
  const detail::NearBodies bodies = detail::nearBodies(device, fluid);
  const WallFieldView view = walls.view();
  detail::sumBodies(device, "push on bodies", fluid, walls.pairs.nearCount(), walls.pairs.bySolid(),
                    detail::SumPushes{bodies, walls.pairs.near(), view.share,
                                      yields ? ArrayView<const float>(view.grip) : ArrayView<const float>{}});
  parallelFor(
      device, "move bodies", walls.views.size(),
      detail::MoveBodies{bodies.solids, walls.bodySums.data(), double(fluid.constants.particleMass), done});
  parallelForUneven(device, "follow bodies", walls.pairs.nearCount(),
                    detail::FollowBodies{.bodies = bodies,
                                         .walls = view,
                                         .near = walls.pairs.near(),
                                         .shares = yields,
                                         .lift = walls.lift.view(),
                                         .displacement = problem.displacement(),
                                         .state = problem.state(),
                                         .done = done});
}

/// Adds to the objective what the bodies' displacements cost.
template <class Backend>
void addBodyEnergy(Backend& device, const PressureProblem& problem, SolverSums* sums) {
  WallField& walls = problem.fluid.walls;
  if (!walls.moves) return;
  parallelFor(device, "energy of bodies", 1,
              detail::AddBodyEnergy{std::as_const(walls.views).view(),
                                    double(problem.fluid.constants.particleMass), sums});
}

/// Before solids near particles are found where the iterations have led.
template <class Backend>
void searchAtBodies(Backend& device, WallField& walls) {
  if (!walls.moves) return;
  parallelFor(device, "search at bodies", walls.views.size(), detail::SearchAtBodies{walls.views.view()});
  walls.sortSolids(device);
}

/// After the solver: bodies stand where it has brought them, with the velocity of that.
template <class Backend>
void endBodies(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  if (!walls.moves) return;
  parallelFor(device, "end of bodies", walls.views.size(),
              detail::EndBodies{walls.views.view(), 1 / fluid.time.dt});
  walls.sortSolids(device);
}

/// Lets bodies give way to the particles that they have stopped, which are walls.met.
template <class Backend>
void shareKicks(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  if (!walls.moves) return;
  const ArrayView<const SolidView> solids = std::as_const(walls.views).view();
  const ArrayView<const int> met = std::as_const(walls.met).view();
  const ArrayView<const Vec3f> positions = fluid.particles.positions().read();
  detail::sumBodies(device, "hits of bodies", fluid, walls.metCount(), walls.hitsBySolid(),
                    detail::SumHits{solids, double(fluid.constants.particleMass), met, positions,
                                    std::as_const(walls.kick).view()});
  parallelFor(device, "hit bodies", solids.size, detail::HitBodies{solids, walls.bodySums.data()});
  parallelForUneven(
      device, "follow hits", walls.metCount(),
      detail::FollowHits{solids, met, positions, fluid.particles.velocities().write(), walls.kick.view()});
}

}  // namespace weir
