#include "nodes/particle_fluid/modules/accelerated_solver.h"

#include "nodes/particle_fluid/body_coupling.h"
#include "nodes/particle_fluid/boundary_forces.h"
#include "nodes/particle_fluid/containment.h"
#include "nodes/particle_fluid/fluid_sums.h"
#include "nodes/particle_fluid/modules/accelerated_judge.h"
#include "nodes/particle_fluid/modules/accelerated_passes.h"
#include "nodes/particle_fluid/modules/conjugate_passes.h"
#include "nodes/particle_fluid/scratch.h"
#include "nodes/particle_fluid/step_length.h"

namespace weir {

namespace {

using Control = AcceleratedSolver::Control;

/// f, unless the pass is done.
template <class F>
struct UnlessDone {
  F f;
  const int* done = nullptr;  // null where nobody knows

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    if (done == nullptr || !*done) f(i);
  }
};

/// An iteration, unless this one takes back what acceleration made of the last.
struct Update {
  StepOf step;
  const Control* control;  // null without tolerance and acceleration
  ArrayView<const Vec3f> predicted;
  ArrayView<Vec3f> displacement;
  ArrayView<Vec4f> state;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    if (control != nullptr && (control->done || control->takesBack)) return;
    step(i, [this](const auto& k, const auto& u, const auto& change) {
      const auto moved = u + change;
      write(displacement, k, moved);
      const auto p = read(predicted, k) + moved;
      write(state, k, {p.x, p.y, p.z, 0});
    });
  }
};

/// Goes on along the change since the last plain update, or back to it.
struct Extrapolate {
  const Control* control;
  ArrayView<Vec3f> plain;
  ArrayView<float> plainShare;  // of the walls; empty without them
  ArrayView<const Vec3f> predicted;
  ArrayView<Vec3f> displacement;
  ArrayView<float> share;
  ArrayView<Vec4f> state;

  WEIR_HD void operator()(std::int64_t i) const {
    if (control->done) return;
    if (plainShare.size > 0) share[i] = extrapolated(plainShare[i], share[i]);
    const Vec3f u = displacement[i], moved = extrapolated(plain[i], u);
    if (moved == u) return;
    displacement[i] = moved;
    const Vec3f p = predicted[i] + moved;
    state[i] = {p.x, p.y, p.z, 0};
  }

  template <class T>
  WEIR_HD T extrapolated(T& before, const T& now) const {
    if (control->takesBack) return before;
    // Nothing is before the first.
    const T moved = control->momentum == 0 ? now : now + control->momentum * (now - before);
    before = now;
    return moved;
  }
};

/// What walls do to the velocities beside holding the fluid: bounce and friction.
struct MeetWalls {
  PushOf pushOf;
  BoundaryView boundary;
  float reach;  // m, at which a wall holds a particle
  float inverseDt;
  ArrayView<const Vec3f> positions;
  ArrayView<const Vec3f> displacement;
  ArrayView<Vec3f> velocities;
  ArrayView<Vec3f> before;  // such that contact is told by how velocities differ; empty where nobody asks

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    forEachNear(boundary, reach, i, read(positions, i), [&](std::int64_t k) { meet(k); });
  }

  WEIR_HD void meet(std::int64_t i) const {
    const BoundaryHit wall = boundaryQuery(boundary, positions[i]);
    if (!(wall.distance < reach)) return;
    // Whatever moved a particle beside the fluid's push is the wall.
    const Vec3f u = displacement[i], v = velocities[i];
    const float held = inverseDt * dot(u - pushOf(i).push, wall.normal);
    if (!(held > 0)) return;
    if (before.size > 0) before[i] -= held * wall.normal;
    velocities[i] = heldByWall(v, wall, -dot(v - inverseDt * u, wall.normal), held);
  }
};

/// What conjugate gradients divide every push by: the divisor of Eq. 14 within a settled fluid, with an
/// integral from 3/4 of a spacing on, where its particles have their neighbours, in place of the sum over
/// these.
///
///   1 + |Ḃ⁻|·2·(c·dt)²·∫|W'|/r dV = 1 + |Ḃ⁻|·30·(c·dt/H)²·(4·p³ − 3·p⁴),   p = 1 − 3/4·d/H
float commonDivisor(const PressureProblem& problem) {
  constexpr float kNearest = 0.75f;  // spacings
  const float radius = problem.fluid.constants.supportRadius;
  const float p = 1 - kNearest * problem.fluid.constants.spacing / radius;
  return 1 + problem.energy.negativePart() * 30 * problem.stiffness() / (radius * radius) * p * p * p *
                 (4 - 3 * p);
}

/// What walls have displaced particles by beside their shares: of boundaries as a change of velocities.
struct DivideHeld {
  WallFieldView walls;
  float inverseDt;
  ArrayView<const Vec3f> positions;
  ArrayView<Vec3f> held;
  ArrayView<Vec3f> before;  // empty where nobody asks

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f all = held[i], p = positions[i];
    if (all == Vec3f{}) return;
    const Vec3f rest = all - walls.share[i] * walls.sharedGradient(i, p);
    const bool ofMeshes = walls.integrals.size > 0 && walls.gradientOfBoundary(p) == Vec3f{};
    held[i] = ofMeshes ? rest : Vec3f{};
    if (!ofMeshes && before.size > 0) before[i] -= inverseDt * rest;
  }
};

/// Shares are over the gradients of a search; between two of them they are displacements, m.
struct ShareOfWalls {
  WallFieldView walls;
  ArrayView<const Vec4f> state;  // positions
  bool asDisplacement;

  WEIR_HD void operator()(std::int64_t i) const {
    const float gradient = length(walls.sharedGradient(i, xyz(state[i])));
    walls.share[i] = asDisplacement ? walls.share[i] * gradient
                     : gradient > 0 ? walls.share[i] / gradient
                                    : 0.0f;
  }
};

}  // namespace

template <class Backend>
void AcceleratedSolver::stepOn(Backend& device, FluidStep& fluid) {
  besideBodies_ = fluid.walls.hasBodies();
  refuseBodies(fluid);
  askForCurvature(fluid);
  PressureProblem problem = problemOf(fluid);
  reserve(fluid);
  fluid.walls.forgetShares();
  if (followsHeld()) held_.fillZero();
  beginStep(device, fluid);
  problem.start(device);
  contain(device, problem);
  fluid.exchange(problem.state());
  if (recordObjective) objective_->begin(fluid, maxPasses() * maxIterations + 1);
  record(problem);
  for (int pass = 0; pass < maxPasses() && !over_; ++pass) {
    if (pass > 0) searchAgain(device, problem);
    if (conjugates())
      iterateConjugate(device, problem, pass);
    else
      iterate(device, problem, pass);
  }
  problem.finish(device);
  endBodies(device, fluid);
  if (controlled()) meetWalls(device, problem);
}

template <class Backend>
void AcceleratedSolver::beginStep(Backend& device, FluidStep& fluid) {
  if (!controlled()) return;
  const Count count = fluid.particles.count();
  const float dt = static_cast<float>(fluid.time.dt);
  const ArrayView<const Vec3f> velocities = fluid.particles.velocities().read();
  over_ = false;
  all_ = countOfAll(fluid);
  if (staged(fluid)) {
    reduce(device, "farthest", count, 0.0f, detail::SquareOfWay{dt, velocities}, Max{}, farthest_.data());
    maxOverRanks(ranksOf(fluid), farthest_);
  }
  constexpr float kStage = 1;  // spacings
  parallelFor(device, "begin", 1,
              detail::BeginStep{.control = control_->data(),
                                .farthest = staged(fluid) ? farthest_.data() : nullptr,
                                .dt = dt,
                                .stage = kStage * fluid.constants.spacing,
                                .max = pathStages});
  if (staged(fluid))
    parallelFor(device, "go back", count,
                detail::GoBack{control_->data(), velocities, fluid.particles.positions().write()});
}

template <class Backend>
void AcceleratedSolver::iterate(Backend& device, const PressureProblem& problem, int pass) {
  const Count count = problem.fluid.particles.count();
  const StepOf step = stepOf(problem, pass > 0 ? carried_.read() : ArrayView<const Vec3f>{});
  const Update update{.step = step,
                      .control = controlled() ? control_->data() : nullptr,
                      .predicted = problem.predicted(),
                      .displacement = problem.displacement(),
                      .state = problem.state()};
  UnlessDone<EnergyDerivative> density{problem.derivative(excess_.view())};
  if (controlled()) parallelFor(device, "begin", 1, detail::BeginPass{control_->data()});
  ++passes_;
  bool over = false;
  for (int k = 0; k < maxIterations && !(over = isDone()); ++k) {
    // Walls may have moved particles since the pass was done, and what was found before that counts; how many
    // iterations come until the host hears of the end must not.
    if (controlled() && k > 0) density.done = &control_->data()->done;
    parallelForEights(device, "density", count, density);
    problem.fluid.exchange(problem.weighted());
    if (searches())
      parallelForEights(device, "propose", count,
                        Propose{step.pushOf, problem.displacement(), proposal_.view()});
    if (controlled() || stepLength == StepLength::kGlobal) {
      sumOverRanks(device, "measure", allOf(problem.fluid), problem.square(), step.measure, AddSums{},
                   sums_.data());
      addBodyEnergy(device, problem, sums_.data());
    }
    if (controlled()) judge(device, problem, /*last=*/k + 1 == maxIterations);
    parallelForEights(device, "update", count, update);
    // The end of a pass is decided above; the host hears of it when the rest of the iteration is launched.
    const Control* control = control_->data();
    const int* done = !controlled() ? nullptr : k > 0 ? &control->done : &control->surplus;
    moveBodies(device, problem, /*yields=*/true, done);
    contain(device, problem, done);
    problem.fluid.exchange(problem.state());
    record(problem);
    if (!accelerated()) continue;
    accelerate(device, problem);
    moveBodies(device, problem, /*yields=*/false, done);
    contain(device, problem, done);
    problem.fluid.exchange(problem.state());
  }
  if (!over) endPass(pass);
}

template <class Backend>
void AcceleratedSolver::iterateConjugate(Backend& device, const PressureProblem& problem, int pass) {
  const ArrayView<const Vec3f> searched = pass > 0 ? carried_.read() : ArrayView<const Vec3f>{};
  parallelFor(device, "begin", 1, detail::BeginPass{control_->data()});
  ++passes_;
  // A pass that begins when all is over must change nothing.
  contain(device, problem, &control_->data()->surplus);
  settle(device, problem, /*first=*/true);
  bool over = false;
  for (int k = 0; k < maxIterations && !(over = isDone()); ++k) {
    iterateOnce(device, problem, searched, /*last=*/k + 1 == maxIterations);
    record(problem);
  }
  if (!over) endPass(pass);
}

template <class Backend>
void AcceleratedSolver::settle(Backend& device, const PressureProblem& problem, bool first) {
  problem.fluid.exchange(problem.state());
  parallelForEights(device, "density", problem.fluid.particles.count(), settleOf(problem, first));
  problem.fluid.exchange(problem.weighted());
}

template <class Backend>
void AcceleratedSolver::iterateOnce(Backend& device, const PressureProblem& problem,
                                    ArrayView<const Vec3f> searched, bool last) {
  const Count count = problem.fluid.particles.count();
  const int* const done = &control_->data()->done;
  directions_.turn();
  const ConjugateView of = conjugateView();
  const detail::ConjugateProblem conjugate{.control = control_->data(),
                                           .of = of,
                                           .energy = bulkEnergy_,
                                           .stiffness = problem.stiffness(),
                                           .tension = tension,
                                           .predicted = problem.predicted(),
                                           .displacement = problem.displacement(),
                                           .share = problem.fluid.walls.view().share,
                                           .state = problem.state()};
  sumOverRanks(device, "measure", allOf(problem.fluid), problem.square(),
               detail::MeasureState{conjugate, searched}, AddSums{}, sums_.data());
  parallelFor(device, "judge", 1, detail::JudgeState{judgeOf(problem, sums_.data(), last)});
  controlSeen_->request(control_->data());
  const detail::Descend descend{.pushOf = problem.push(),
                                .divisor = commonDivisor(problem),
                                .of = of,
                                .control = control_->data(),
                                .predicted = problem.predicted(),
                                .displacement = problem.displacement(),
                                .state = problem.state()};
  parallelForEights(
      device, "descend", count,
      detail::Contained<detail::Descend>{descend, containOf(problem, of.tried, done, of.heldChange)});
  DirectionSums* const sums = directions_.directionSums.data();
  sumOverRanks(device, "measure direction", allOf(problem.fluid), problem.square(),
               detail::MeasureDirection{conjugate}, AddDirectionSums{}, sums);
  parallelFor(device, "choose direction", 1, detail::ChooseDirection{control_->data(), sums});
  parallelForEights(
      device, "try", count,
      detail::Contained<detail::OneByOne<detail::Try>>{{{conjugate}}, containOf(problem, of.tried, done)});
  problem.fluid.exchange(problem.state());
  parallelForEights(device, "try density", count,
                    detail::SumTrial{detail::RelativeExcess::of(problem), control_->data(), of});
  sumOverRanks(device, "measure line", allOf(problem.fluid), problem.square(), detail::MeasureLine{conjugate},
               AddLineSums{}, directions_.lineSums.data());
  parallelFor(device, "choose length", 1,
              detail::ChooseLength{control_->data(), directions_.lineSums.data(), last});
  parallelForEights(
      device, "advance", count,
      detail::AdvanceAndSettle{{{{conjugate}}, containOf(problem, problem.displacement(), done, of.held)},
                               settleOf(problem, /*first=*/false)});
  settle(device, problem, /*first=*/false);
}

template <class Backend>
void AcceleratedSolver::judge(Backend& device, const PressureProblem& problem, bool last) {
  parallelFor(device, "judge", 1, judgeOf(problem, sums_.data(), last));
  controlSeen_->request(control_->data());
}

template <class Backend>
void AcceleratedSolver::accelerate(Backend& device, const PressureProblem& problem) {
  const Count count = problem.fluid.particles.count();
  const WallFieldView walls = problem.fluid.walls.view();
  parallelFor(device, "extrapolate", count,
              Extrapolate{.control = control_->data(),
                          .plain = plain_.view(),
                          .plainShare = walls.share.size == 0 ? ArrayView<float>{} : plainShare_.view(),
                          .predicted = problem.predicted(),
                          .displacement = problem.displacement(),
                          .share = walls.share,
                          .state = problem.state()});
}

template <class Backend>
void AcceleratedSolver::contain(Backend& device, const PressureProblem& problem, const int* done) {
  if (!controlled() || problem.fluid.walls.boundary.empty()) return;
  parallelForEights(device, "contain", problem.fluid.particles.count(),
                    containOf(problem, problem.displacement(), done, conjugateView().held));
}

template <class Backend>
void AcceleratedSolver::meetWalls(Backend& device, const PressureProblem& problem) {
  constexpr float kTouching = 1.001f;
  FluidStep& fluid = problem.fluid;
  WallField& walls = fluid.walls;
  if (walls.boundary.empty()) {
    if (followsHeld()) divideHeld(device, problem, {});
    return;
  }
  addContactImpulses(device, fluid, [&] {
    parallelForEights(device, "walls", fluid.particles.count(),
                      MeetWalls{.pushOf = problem.push(),
                                .boundary = walls.boundary.boundary,
                                .reach = kTouching * fluid.constants.contact,
                                .inverseDt = problem.inverseDt(),
                                .positions = problem.predicted(),
                                .displacement = problem.displacement(),
                                .velocities = fluid.particles.velocities().write(),
                                .before = walls.reports() && !followsHeld() ? walls.velocitiesBefore.view()
                                                                            : ArrayView<Vec3f>{}});
    if (followsHeld())
      divideHeld(device, problem, walls.reports() ? walls.velocitiesBefore.view() : ArrayView<Vec3f>{});
  });
}

template <class Backend>
void AcceleratedSolver::divideHeld(Backend& device, const PressureProblem& problem, ArrayView<Vec3f> before) {
  WallField& walls = problem.fluid.walls;
  parallelFor(device, "held", problem.fluid.particles.count(),
              DivideHeld{.walls = walls.view(),
                         .inverseDt = problem.inverseDt(),
                         .positions = problem.predicted(),
                         .held = held_.write(),
                         .before = before});
  if (walls.curves) walls.remainder = held_.read();
}

template <class Backend>
void AcceleratedSolver::searchAgain(Backend& device, PressureProblem& problem) {
  FluidStep& fluid = problem.fluid;
  const auto convertShares = [&](bool asDisplacement) {
    if (!fluid.walls.empty())
      parallelFor(device, "shares", fluid.particles.count(),
                  ShareOfWalls{fluid.walls.view(), problem.state(), asDisplacement});
  };
  convertShares(true);
  parallelFor(device, "move", fluid.particles.count(),
              detail::MoveOut{.control = control_->data(),
                              .displacement = problem.displacement(),
                              .velocities = fluid.particles.velocities().read(),
                              .carried = carried_.write(),
                              .positions = fluid.particles.positions().write()});
  searchAtBodies(device, fluid.walls);
  problem.withoutRooms([&] { fluid.findNeighbors(); });
  reserve(fluid);  // other ranks may have given particles
  all_ = countOfAll(fluid);
  fluid.findWalls();
  // The sort has put the particles, and what is carried, into another order and other memory.
  parallelFor(device, "move", fluid.particles.count(),
              detail::MoveBack{.carried = carried_.read(),
                               .displacement = problem.displacement(),
                               .positions = fluid.particles.positions().write(),
                               .state = problem.state()});
  fluid.exchange(problem.state());
  if (fluid.walls.empty()) return;
  convertShares(false);
  fluid.walls.keepLegal(fluid.particles.positions().read());
}

template void AcceleratedSolver::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
