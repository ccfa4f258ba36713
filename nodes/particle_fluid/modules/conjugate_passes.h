// The kernels of an iteration by conjugate gradients, in their order (conjugate.h).
#pragma once

#include "nodes/particle_fluid/containment.h"
#include "nodes/particle_fluid/modules/accelerated_judge.h"
#include "nodes/particle_fluid/modules/conjugate.h"
#include "nodes/particle_fluid/pressure_problem.h"

namespace weir::detail {

/// What all of them work on.
struct ConjugateProblem {
  const SolverControl* control;
  ConjugateView of;
  BulkEnergy energy;
  float stiffness;  // (c·dt)²
  bool tension;
  ArrayView<const Vec3f> predicted;
  ArrayView<Vec3f> displacement;
  ArrayView<float> share;  // of walls; empty without them
  ArrayView<Vec4f> state;  // positions of what is contained, or summed over, next

  WEIR_HD void place(std::int64_t i, const Vec3f& u) const {
    const Vec3f p = predicted[i] + u;
    state[i] = {p.x, p.y, p.z, 0};
  }
  /// E of a particle, and Ḃ.
  WEIR_HD double energyAt(const Vec3f& u, float excess) const {
    return 0.5 * double(dot(u, u)) + double(stiffness) * double(energy.value(excessOf(excess + 1, tension)));
  }
};

/// λ − 1.
struct RelativeExcess {
  NeighborView neighbors;
  SpikyKernel kernel;
  float particleVolume;
  WallFieldView walls;
  ArrayView<const Vec4f> state;

  static RelativeExcess of(const PressureProblem& problem) {
    const FluidStep& fluid = problem.fluid;
    return {.neighbors = fluid.neighbors.view(),
            .kernel = fluid.constants.kernel,
            .particleVolume = fluid.constants.particleVolume,
            .walls = problem.fluid.walls.view(),
            .state = problem.state()};
  }
  template <class Index>
  WEIR_HD auto at(Index i) const {
    auto lambda = relativeDensity(i, neighbors, kernel, particleVolume, state);
    if (!walls.empty()) lambda += walls.phi(i, xyz(read(state, i)));
    return lambda - 1;
  }
};

/// The end of a step along a direction: λ − 1, Ḃ for the push, and the direction as solids have let it go.
struct Settle {
  RelativeExcess density;
  const SolverControl* control;
  ConjugateView of;
  BulkEnergy energy;
  bool tension;
  bool first;  // of a pass: nothing is known yet
  ArrayView<const Vec3f> displacement;
  ArrayView<Vec4f> weighted;

  /// Where λ has to be summed anew.
  template <class Index>
  WEIR_HD void operator()(Index i) const {
    if (!first && (control->done || !control->far)) return;
    write(of.excess, i, density.at(i));
    finish(i);
  }

  /// Where λ is known: needs nothing of other particles.
  template <class Index>
  WEIR_HD void withoutSum(Index i) const {
    if (!control->done && !control->far) finish(i);
  }

 private:
  template <class Index>
  WEIR_HD void finish(Index i) const {
    const auto s = read(density.state, i);
    const auto excess = read(of.excess, i);
    write(weighted, i, {s.x, s.y, s.z, energy.derivative(excessOf(excess + 1, tension))});
    if (first || control->takesBack) return;
    write(of.direction, i, (read(displacement, i) - read(of.tried, i)) / float(control->length));
    if (of.held.size > 0)
      write(of.heldDirection, i, (read(of.held, i) - read(of.heldChange, i)) / float(control->length));
  }
};

/// What is known where an iteration begins, and whether there is to be one.
struct MeasureState {
  ConjugateProblem problem;
  ArrayView<const Vec3f> searched;  // displacements at the search; all 0 if it is empty

  WEIR_HD SolverSums operator()(std::int64_t i) const {
    const Vec3f u = problem.displacement[i];
    const Vec3f way = searched.size > 0 ? u - searched[i] : u;
    const float e = problem.of.excess[i];
    return {.compression = e > 0 ? double(e) : 0.0,
            .objective = problem.energyAt(u, e),
            .farthest = double(dot(way, way)),
            .displaced = 0.5 * double(dot(u, u))};
  }
};

/// Whether to go on, or to take the last step back.
struct JudgeState {
  Judge judge;

  WEIR_HD void operator()(std::int64_t) const {
    SolverControl& control = *judge.control;
    if (control.done) return;
    decide(control);
    if (control.done || judge.last) judge.plan();
  }

  WEIR_HD void decide(SolverControl& control) const {
    constexpr double kRounding = 1e-5;  // of the terms of the sum, which are floats
    // So many iterations on end that lower the objective by no more lead nowhere: the compression is what
    // inertia and stiffness ask for. Without a tolerance, until all is lost in rounding.
    const double least = judge.tolerance > 0 ? 1e-5 : 1e-7;
    const int patience = judge.tolerance > 0 ? 4 : 100;
    // Little compression alone does not mean that particles have come to rest, and energy that should be lost
    // would be left: the last step must not have lowered the objective by more than this share, or than
    // GainTolerance (engineering/convergence.md).
    constexpr double kSettled = 0.005;
    constexpr int kMin = 3;  // see Judge::judge()
    const double objective = judge.sums->objective;
    // NaN counts as risen.
    const bool rose = control.sinceRestart > 0 && !(objective <= (1 + kRounding) * control.objective);
    control.takesBack = rose ? 1 : 0;
    control.met = judge.meets() && !rose ? 1 : 0;
    // Neighbours that were found anew where iterations had converged seldom change anything.
    const bool again = control.begun > 1 && !control.advance;
    const double gain = control.objective - objective;
    const double share = kSettled * control.objective, tolerated = toleratedGain();
    const bool settled = control.sinceRestart > 0 ? gain < (share > tolerated ? share : tolerated) : again;
    const bool gains = control.objective == 0 || objective < (1 - least) * control.objective;
    control.withoutGain = gains ? 0 : control.withoutGain + 1;
    const bool givesUp = judge.exhausted() && !rose;
    if (givesUp || (control.iterations >= kMin && control.met && settled) ||
        control.withoutGain >= patience) {
      control.done = 1;
      return;
    }
    judge.countIteration();
    if (rose) return takeBack(control);
    if (control.objective == 0 || objective < control.objective) control.objective = objective;
  }

  /// GainTolerance of all particles.
  WEIR_HD double toleratedGain() const {
    const double particles = double(judge.count.get());
    return particles > 0 ? particles * judge.gainTolerance.at(judge.sums->displaced / particles) : 0;
  }

  WEIR_HD static void takeBack(SolverControl& control) {
    constexpr double kShorter = 0.125;
    control.sinceRestart = 0;
    control.trial = kShorter * control.length;
  }
};

/// The gradient, and u + z.
struct Descend {
  PushOf pushOf;
  float divisor;
  ConjugateView of;
  const SolverControl* control;
  ArrayView<const Vec3f> predicted, displacement;
  ArrayView<Vec4f> state;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    if (control->done || control->takesBack) return;
    const auto at = pushOf(i);
    const auto u = read(displacement, i);
    const auto descent = at.push - u;
    write(of.gradient, i, -descent);
    const auto moved = u + descent / divisor;
    write(of.tried, i, moved);
    const auto p = read(predicted, i) + moved;
    write(state, i, {p.x, p.y, p.z, 0});
    if (of.share.size > 0) write(of.shareChange, i, (at.wall - read(pushOf.walls.share, i)) / divisor);
    if (of.held.size > 0) write(of.heldChange, i, (at.byWalls - read(of.held, i)) / divisor);
  }
};

struct MeasureDirection {
  ConjugateProblem problem;

  WEIR_HD DirectionSums operator()(std::int64_t i) const {
    const ConjugateView& of = problem.of;
    const Vec3f z = of.tried[i] - problem.displacement[i];
    const bool alone = problem.control->sinceRestart == 0;  // there is no direction before it
    return {.slope = -double(dot(z, of.gradient[i])),
            .turned = alone ? 0.0 : -double(dot(z, of.previous[i])),
            .forward = alone ? 0.0 : double(dot(of.direction[i], of.gradient[i]))};
  }
};

/// Along which direction.
struct ChooseDirection {
  SolverControl* control;
  const DirectionSums* sums;

  WEIR_HD void operator()(std::int64_t) const {
    constexpr double kDownhill = 0.1;  // of the slope along z, which a direction must have at least
    if (control->done || control->takesBack) return;
    double beta = 0;
    if (control->sinceRestart++ > 0 && control->slope > 0)
      beta = (sums->slope - sums->turned) / control->slope;
    const bool good = beta > 0 && sums->slope - beta * sums->forward > kDownhill * sums->slope;
    control->momentum = good ? float(beta) : 0.0f;
    control->slope = sums->slope;
    if (!(control->trial > 0)) control->trial = 1;
  }
};

/// To where the step is tried; or back to where the last one began.
struct Try {
  ConjugateProblem problem;

  WEIR_HD void operator()(std::int64_t i) const {
    const SolverControl& control = *problem.control;
    const ConjugateView& of = problem.of;
    const Vec3f u = problem.displacement[i];
    if (control.done) return problem.place(i, u);
    if (control.takesBack) return goBack(i, u);
    const Vec3f z = of.tried[i] - u;
    const Vec3f p = control.momentum == 0 ? z : z + control.momentum * of.direction[i];
    of.direction[i] = p;
    if (of.share.size > 0)
      of.share[i] =
          control.momentum == 0 ? of.shareChange[i] : of.shareChange[i] + control.momentum * of.share[i];
    if (of.held.size > 0)
      of.heldDirection[i] = control.momentum == 0 ? of.heldChange[i]
                                                  : of.heldChange[i] + control.momentum * of.heldDirection[i];
    const Vec3f tried = u + float(control.trial) * p;
    of.tried[i] = tried;
    problem.place(i, tried);
  }

  WEIR_HD void goBack(std::int64_t i, const Vec3f& u) const {
    const ConjugateView& of = problem.of;
    const Vec3f before = u - float(problem.control->length) * of.direction[i];
    if (of.share.size > 0) problem.share[i] -= float(problem.control->length) * of.share[i];
    if (of.held.size > 0) of.held[i] -= float(problem.control->length) * of.heldDirection[i];
    problem.displacement[i] = before;
    of.tried[i] = before;
    problem.place(i, before);
  }
};

/// λ where the step is tried.
struct SumTrial {
  RelativeExcess density;
  const SolverControl* control;
  ConjugateView of;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    if (!control->done) write(of.triedExcess, i, density.at(i));
  }
};

struct MeasureLine {
  ConjugateProblem problem;

  WEIR_HD LineSums operator()(std::int64_t i) const {
    const ConjugateView& of = problem.of;
    const Vec3f tried = of.tried[i], way = tried - problem.displacement[i];
    const float before = of.excess[i], after = of.triedExcess[i];
    const float derivative = problem.energy.derivative(excessOf(after + 1, problem.tension));
    return {
        double(dot(way, of.gradient[i])),
        double(dot(way, tried)) + double(problem.stiffness) * double(derivative) * double(after - before)};
  }
};

/// α. Where slopes do not say it, four times as far as was tried.
struct ChooseLength {
  SolverControl* control;
  const LineSums* sums;
  bool last;  // of a pass: its outcome is not judged, so it goes no further than where it was tried

  WEIR_HD void operator()(std::int64_t) const {
    constexpr double kMin = 0.1, kMax = 4, kFar = 0.4;
    control->far = 0;
    if (control->done || control->takesBack) return;
    double part = 1;
    if (sums->atStart < 0)
      part = sums->atTrial > sums->atStart ? sums->atStart / (sums->atStart - sums->atTrial) : kMax;
    part = part < kMin ? kMin : part > kMax ? kMax : part;
    if (last && part > 1) part = 1;
    // Where all has converged, slopes are noise, and so is what they say.
    constexpr double kShortest = 0.125, kLongest = 64;
    const double length = control->trial * part;
    control->length = length < kShortest ? kShortest : length > kLongest ? kLongest : length;
    part = control->length / control->trial;
    control->part = part;
    control->trial = control->length;
    control->far = part < 1 - kFar || part > 1 + kFar ? 1 : 0;
  }
};

/// To u + α·p; `tried` then is where the step began.
struct Advance {
  ConjugateProblem problem;

  WEIR_HD void operator()(std::int64_t i) const {
    const SolverControl& control = *problem.control;
    const ConjugateView& of = problem.of;
    if (control.done) return;
    if (control.takesBack) {
      of.excess[i] = of.triedExcess[i];
      return;
    }
    const Vec3f u = problem.displacement[i], moved = u + float(control.length) * of.direction[i];
    of.excess[i] += float(control.part) * (of.triedExcess[i] - of.excess[i]);
    if (of.share.size > 0) problem.share[i] += float(control.length) * of.share[i];
    if (of.held.size > 0) {
      of.heldChange[i] = of.held[i];
      of.held[i] += float(control.length) * of.heldDirection[i];
    }
    of.tried[i] = u;
    problem.displacement[i] = moved;
    problem.place(i, moved);
  }
};

/// A pass over the particles, each of which is put out of solids at once.
template <class F>
struct Contained {
  F f;
  Contain contain;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    f(i);
    contain(i);
  }
};

/// f for one index at a time, where contain takes eight.
template <class F>
struct OneByOne {
  F f;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    forEachOf(i, f);
  }
};

/// The last pass of an iteration.
struct AdvanceAndSettle {
  Contained<OneByOne<Advance>> advance;
  Settle settle;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    advance(i);
    settle.withoutSum(i);
  }
};

}  // namespace weir::detail
