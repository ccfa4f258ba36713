#include "nodes/particle_fluid/modules/two_projections.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "nodes/particle_fluid/fluid_sums.h"
#include "nodes/particle_fluid/modules/pbf_passes.h"
#include "nodes/particle_fluid/modules/projection_bodies.h"
#include "nodes/particle_fluid/modules/projection_moments.h"
#include "nodes/particle_fluid/modules/projection_passes.h"

namespace weir {

using namespace projection;

namespace {

constexpr float kRelaxation = 0.5f;  // of the correction of positions
constexpr float kSoftening = 1e-2f;  // per spacing², for particles with hardly a neighbour
constexpr int kRounds = 6;           // of conjugate gradients, each with other particles under pressure

/// What walls carry of the fluid's fall.
struct Carry {
  ArrayView<const Vec3f> carried;
  ArrayView<Vec3f> u;
  WEIR_HD void operator()(std::int64_t i) const { u[i] += carried[i]; }
};

/// v, the displacement dt·(v − v*) and where it leads; the share of walls in it.
struct Finish {
  float dt, toPressure;
  WallFieldView walls;
  ArrayView<const float> q;
  ArrayView<const Vec3f> positions, u, push, wall;
  ArrayView<Vec4f> state;
  ArrayView<Vec3f> displacement;  // on entry what walls carry
  ArrayView<Vec3f> velocities;
  ArrayView<float> pressure;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f v = u[i] + push[i], p = xyz(state[i]), to = p + dt * v;
    const Vec3f byWalls = q[i] * wall[i] + displacement[i];
    velocities[i] = v;
    displacement[i] = to - positions[i];
    state[i] = {to.x, to.y, to.z, 0};
    pressure[i] = toPressure * q[i];
    if (walls.share.size == 0) return;
    const Vec3f toWall = walls.sharedGradient(i, p);
    const float square = dot(toWall, toWall);
    if (square > 0) walls.share[i] += dt * dot(byWalls, toWall) / square;
  }
};

/// M on a lattice, inside the fluid.
double momentInside(const FluidConstants& c) {
  const PairGradient gradient = pairGradientOf(c);
  const int reach = static_cast<int>(c.supportRadius / c.spacing) + 1, wide = 2 * reach + 1;
  double sum = 0;
  for (int k = 0; k < wide * wide * wide; ++k) {
    const int x = k % wide - reach, y = k / wide % wide - reach, z = k / wide / wide - reach;
    const float far = c.spacing * std::sqrt(float(x * x + y * y + z * z));
    if (far > 0) sum += gradient.weight(far) * c.spacing * c.spacing * float(x * x);
  }
  return sum;
}

/// k over −dΦ/dy, such that layers of fluid at a plane, with N as it is on a lattice, bear an even pressure:
/// Σ d·k·N = 1.
float shareOf(const FluidConstants& c) {
  double sum = 0;
  for (double y = 0.5 * c.spacing; y < c.supportRadius; y += c.spacing)
    sum -= c.spacing / c.supportRadius * faceIntegrals(y / c.supportRadius).slope;
  return static_cast<float>(momentInside(c) / sum);
}

WallPlanes planesOf(const FluidStep& fluid) {
  const WallField& walls = fluid.walls;
  const FluidConstants& c = fluid.constants;
  return {.boundary = walls.boundary.boundary,
          .meshes = {.solids = walls.views.view(),
                     .pairs = walls.pairs.view(),
                     .each = walls.each.view(),
                     .predicted = fluid.particles.positions().read(),
                     .radius = c.wallRadius,
                     .factor = c.wallFactor},
          .radius = c.supportRadius,
          .share = shareOf(c)};
}

}  // namespace

template <class Backend>
void TwoProjections::findMoments(Backend& device, FluidStep& fluid) {
  const Count count = fluid.particles.count();
  const WallPlanes planes = planesOf(fluid);
  parallelFor(device, "near walls", count,
              FindNearWalls{planes, state_.view(), wallDistances_.view(), wallKeys_.view()});
  fluid.exchange(wallDistances_.view());
  fluid.exchange(wallKeys_.view());
  parallelFor(device, "moments", count,
              FindMoments{.packing = packingOf(fluid),
                          .walls = fluid.walls.view(),
                          .planes = planes,
                          .dt = static_cast<float>(fluid.time.dt),
                          .fall = static_cast<float>(fluid.time.dt) * fluid.time.gravity,
                          .velocities = u_.view(),
                          .q = q_.view(),
                          .diagonal = diagonal_.view(),
                          .off = off_.view(),
                          .wall = wall_.view(),
                          .carried = displacement_.view(),
                          .wallOfPair = wallOfPair_.view(),
                          .room = room_.view()});
  fluid.exchange(diagonal_.view());
  fluid.exchange(off_.view());
}

template <class Backend>
void TwoProjections::smooth(Backend& device, FluidStep& fluid) {
  fluid.exchange(u_.view());
  if (!(smoothing > 0)) return;
  const Count count = fluid.particles.count();
  const ProjectionPacking packing = packingOf(fluid);
  parallelFor(device, "gradients", count,
              FindGradients{packing, planesOf(fluid), u_.view(), rowX_.view(), rowY_.view(), rowZ_.view()});
  for (Array<Vec3f>* row : {&rowX_, &rowY_, &rowZ_}) fluid.exchange(row->view());
  parallelFor(device, "smooth", count,
              Smooth{packing, smoothing, u_.view(), rowX_.view(), rowY_.view(), rowZ_.view(), push_.view()});
  u_.swap(push_);
  fluid.exchange(u_.view());
}

template <class Backend>
void TwoProjections::apply(Backend& device, FluidStep& fluid, Count count, const Array<float>& of) {
  const ProjectionPacking packing = packingOf(fluid);
  parallelFor(device, "push", count, projection::PushOf{packing, of.view(), push_.view()});
  fluid.exchange(push_.view());
  parallelFor(device, "divergence", count, Divergence{packing, push_.view(), product_.view()});
  if (fluid.walls.moves) changeBodies(device, fluid, SumWrenches{bodiesOf(fluid), of.view()}, product_);
}

template <class Backend, class Sum>
void TwoProjections::changeBodies(Backend& device, FluidStep& fluid, const Sum& sum,
                                  Array<float>& divergence) {
  const WallField& walls = fluid.walls;
  const BodiesAtParticles bodies = bodiesOf(fluid);
  sumByKeyOverRanks(device, "wrenches", {ranksOf(fluid), walls.pairs.nearCount(), walls.pairs.bySolid()},
                    bodies.solids.size, sum, weir::detail::AddTwists{}, wrenches_.data());
  parallelFor(device, "change bodies", bodies.solids.size,
              ChangeBodies{bodies.solids, wrenches_.data(), bodies.particleMass});
  parallelForUneven(device, "add bodies", walls.pairs.nearCount(), AddBodies{bodies, divergence.view()});
}

template <class Backend>
void TwoProjections::carryBodies(Backend& device, FluidStep& fluid) {
  const BodiesAtParticles bodies = bodiesOf(fluid);
  changeBodies(device, fluid, SumCarried{bodies}, source_);
  parallelFor(device, "displace bodies", bodies.solids.size, DisplaceBodies{bodies.solids, fluid.time.dt});
  parallelForUneven(device, "precondition bodies", fluid.walls.pairs.nearCount(),
                    PreconditionBodies{bodies, preconditioner_.view()});
}

template <class Backend>
void TwoProjections::moveBodies(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  if (!walls.moves) return;
  walls.moved = true;
  const BodiesAtParticles bodies = bodiesOf(fluid);
  parallelFor(device, "displace bodies", bodies.solids.size, DisplaceBodies{bodies.solids, fluid.time.dt});
  parallelForUneven(device, "tell of bodies", walls.pairs.nearCount(),
                    TellOfBodies{.bodies = bodies,
                                 .dt = static_cast<float>(fluid.time.dt),
                                 .q = std::as_const(q_).view(),
                                 .lift = walls.lift.view(),
                                 .share = walls.share.write(),
                                 .each = walls.each.view()});
  endBodies(device, fluid);
}

template <class Backend>
void TwoProjections::iterateOnce(Backend& device, FluidStep& fluid, double enough, ProjectionSums* before) {
  const Count all = fluid.particles.count(), count{all.bound, active_.data()};
  ProjectionSums* after = before + 1;
  const SumTerms terms{residual_.view(), direction_.view(), product_.view(), preconditioner_.view()};
  const OnAllRanks ranks{ranksOf(fluid), count};
  fluid.exchange(direction_.view());
  apply(device, fluid, count, direction_);
  sumOverRanks(device, "sums", ranks, terms, projection::AddSums{}, before);
  parallelFor(device, "judge", 1, Judge{all, enough, before, active_.data()});
  parallelFor(device, "advance", count,
              Advance{before, direction_.view(), product_.view(), q_.view(), residual_.view()});
  sumOverRanks(device, "sums", ranks, terms, projection::AddSums{}, after);
  parallelFor(device, "turn", count,
              Turn{before, after, residual_.view(), preconditioner_.view(), direction_.view()});
}

template <class Backend>
bool TwoProjections::iterate(Backend& device, FluidStep& fluid, double squares) {
  parallelFor(device, "judge", 1, Judge{fluid.particles.count(), 0, nullptr, active_.data()});
  for (int done = 0, together; done < maxIterations; done += together) {
    together = done == 0 ? 1 : std::min<int>(kTogether, maxIterations - done);
    const double enough = (done == 0 ? 1 : 0.1) * squares;
    for (int k = 0; k < together; ++k) iterateOnce(device, fluid, enough, sums_.data() + 2 * k);
    const std::vector<ProjectionSums> sums = sums_.toHost();
    for (int k = 0; k < together; ++k) {
      if (!goesOn(sums[static_cast<std::size_t>(2 * k)], enough)) return true;
      ++record_->iterations;
    }
  }
  return false;
}

template <class Backend>
void TwoProjections::project(Backend& device, FluidStep& fluid) {
  const Count count = fluid.particles.count();
  const double change = tolerance / fluid.time.dt,
               squares = change * change * double(countOfAll(fluid).bound);
  const ProjectionPacking packing = packingOf(fluid);
  parallelFor(device, "source", count, Divergence{packing, u_.view(), source_.view()});
  parallelFor(device, "preconditioner", count, FindPreconditioner{packing, preconditioner_.view()});
  if (fluid.walls.moves) carryBodies(device, fluid);
  bool finished = false;
  for (int round = 0; round < kRounds && !finished; ++round) {
    fluid.exchange(q_.view());
    apply(device, fluid, count, q_);
    parallelFor(device, "start", count,
                Start{source_.view(), product_.view(), room_.view(), q_.view(), preconditioner_.view(),
                      residual_.view(), direction_.view()});
    const std::int64_t before = record_->iterations;
    const bool ended = iterate(device, fluid, squares);
    finished = ended && record_->iterations == before;
    parallelFor(device, "clamp", count, Clamp{q_.view()});
  }
  ++record_->steps;
  if (!finished) ++record_->unfinished;
  fluid.exchange(q_.view());
  apply(device, fluid, count, q_);
}

template <class Backend>
void TwoProjections::correct(Backend& device, FluidStep& fluid) {
  const FluidConstants& c = fluid.constants;
  const Count count = fluid.particles.count();
  const PairGradient gradient = pairGradientOf(c);
  const auto positions = fluid.particles.positions().write().view();
  WallFieldView walls = fluid.walls.view();
  walls.share = {};  // no momentum is in it
  fluid.exchange(state_.view());
  parallelFor(device, "multipliers", count,
              pbf::Multiplier{.neighbors = fluid.neighbors.view(),
                              .gradient = gradient,
                              .relaxation = kSoftening / (c.spacing * c.spacing),
                              .scale = kRelaxation,
                              .tension = false,
                              .walls = walls,
                              .state = state_.view(),
                              .weighted = weighted_.view()});
  fluid.exchange(weighted_.view());
  parallelFor(device, "correct", count,
              pbf::Correct{.neighbors = fluid.neighbors.view(),
                           .gradient = gradient,
                           .repulsion = 0,
                           .inverseValue = 0,
                           .walls = walls,
                           .predicted = positions,
                           .weighted = weighted_.view(),
                           .displacement = displacement_.view(),
                           .state = state_.view()});
  parallelFor(
      device, "finish", count,
      FinishDisplacement{0, displacement_.view(), positions, fluid.particles.velocities().write().view()});
}

template <class Backend>
void TwoProjections::stepOn(Backend& device, FluidStep& fluid) {
  fit(fluid);
  const FluidConstants& c = fluid.constants;
  const Count count = fluid.particles.count();
  const float dt = static_cast<float>(fluid.time.dt);
  const auto positions = fluid.particles.positions().read();
  const auto velocities = fluid.particles.velocities().write().view();
  fluid.walls.forgetShares();
  parallelFor(device, "begin", count,
              Begin{dt, dt / c.restDensity, positions, velocities, pressure_.read(), state_.view(), u_.view(),
                    q_.view()});
  fluid.exchange(state_.view());
  findMoments(device, fluid);
  smooth(device, fluid);
  parallelFor(device, "carry", count, Carry{displacement_.view(), u_.view()});
  fluid.exchange(u_.view());
  project(device, fluid);
  parallelFor(device, "velocities", count,
              Finish{.dt = dt,
                     .toPressure = c.restDensity / dt,
                     .walls = fluid.walls.view(),
                     .q = q_.view(),
                     .positions = positions,
                     .u = u_.view(),
                     .push = push_.view(),
                     .wall = wall_.view(),
                     .state = state_.view(),
                     .displacement = displacement_.view(),
                     .velocities = velocities,
                     .pressure = pressure_.write()});
  moveBodies(device, fluid);
  correct(device, fluid);
}

template void TwoProjections::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
