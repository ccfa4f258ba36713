// How the iterations of AcceleratedSolver go on, decided on the device.
#pragma once

#include "framework/compute/parallel.h"
#include "nodes/particle_fluid/modules/accelerated_control.h"
#include "nodes/particle_fluid/solver_sums.h"

namespace weir::detail {

/// How much the last iteration of a step by conjugate gradients may still lower the objective, m² of each
/// particle: energy that an exact step would not leave, over m/dt².
///
///   min(0.05·(c·dt)²·B(tolerance), max(0.1·w, 0.3·(e − w))),   w = ½·(g·dt²)²,   e = mean of ½·|u|²
///
/// w is what weight makes in a step. If that were left, water at rest would sink until its compression asks
/// for more, and bounce. u = x − x* is what pressure and walls displace a particle by within the step. As x*
/// holds the velocity and the weight, u is the same for whoever moves past, and 0 in fluid that falls freely.
/// In calm water u undoes the weight, so e = w, and the second term vanishes. Where water splashes, e is
/// several times w: pressures are, and so is the motion that they make and take away.
struct GainTolerance {
  double bulk = 0;    ///< the first term; more gives energy to a collapse
  double weight = 0;  ///< w; 0 without gravity, where there is no other term than the first

  WEIR_HD double at(double displaced) const {
    constexpr double kOfWeight = 0.1, kOfSplash = 0.3;
    if (!(weight > 0)) return bulk;
    const double calm = kOfWeight * weight, splash = kOfSplash * (displaced - weight);
    const double most = splash > calm ? splash : calm;  // NaN leaves water calm
    return most < bulk ? most : bulk;
  }
};

/// Whether to go on, and with which momentum: k/(k + 3) in the k-th iteration since the last restart.
struct Judge {
  SolverControl* control;
  const SolverSums* sums;
  Count count;
  double tolerance;             // below 0: never done
  GainTolerance gainTolerance;  // see JudgeState
  bool accelerated;
  double farthest;    // m², squared; from here on, lists no longer hold
  double nearest;     // m², squared; up to here, they hold as well as new ones; below 0: nobody asks
  int maxRepeats;     // of a stage
  int maxIterations;  // of a step
  int passes;         // of the last stage
  bool last;          // of the pass: its outcome is not judged, so it is plain

  WEIR_HD void operator()(std::int64_t) const {
    if (control->done) return;
    judge();
    if (control->done || last) plan();
  }

  /// What the next pass is.
  WEIR_HD void plan() const {
    const bool far = maxRepeats > 0 && sums->farthest > farthest;
    if (far && control->repeats < maxRepeats && !exhausted()) {
      ++control->repeats;
      control->advance = 0;
      return;
    }
    const int left = control->stages - control->stage;
    control->advance = exhausted() ? left : left > 0 ? 1 : 0;
    if (control->advance) {
      control->stage += control->advance;
      control->repeats = 0;
      return;
    }
    control->over = ++control->finals >= passes || sums->farthest <= nearest || exhausted() ? 1 : 0;
    // What lists that do not hold say of compression is not true.
    if (far) control->met = 0;
  }

  /// Whether the tolerance is met by the mean compression.
  WEIR_HD bool meets() const {
    const std::int64_t particles = count.get();
    return (particles > 0 ? sums->compression / double(particles) : 0.0) <= tolerance;
  }

  /// Whether the step has had all its iterations.
  WEIR_HD bool exhausted() const { return control->iterations >= maxIterations; }

  WEIR_HD void countIteration() const {
    ++control->iterations;
    ++control->total;
    if (control->iterations > control->max) control->max = control->iterations;
  }

  WEIR_HD void judge() const {
    // The terms of the sum are floats; it may rise by rounding.
    constexpr double kRounding = 1e-6;
    // Compression that no step touches because it is below the tolerance would gather over the steps.
    constexpr int kMin = 3;
    // With acceleration, an objective that no longer falls is at its least, and the compression is what
    // inertia and stiffness ask for.
    constexpr double kStall = 1e-5;
    constexpr int kInFlight = 3;
    // What overshoots is taken back. It can also tear the fluid apart, so little compression alone
    // does not mean that it is done.
    // NaN counts as risen.
    const bool rose = !(sums->objective <= (1 + kRounding) * control->objective);
    control->takesBack = control->momentum > 0 && rose ? 1 : 0;
    control->met = meets() && !control->takesBack ? 1 : 0;
    const bool stalls = tolerance > 0 && !control->takesBack && control->sinceRestart > kInFlight &&
                        control->momentum > 0 && sums->objective > (1 - kStall) * control->objective;
    const bool givesUp = exhausted() && !control->takesBack;
    if (givesUp || (control->iterations >= kMin && (control->met || stalls))) {
      control->done = 1;
      return;
    }
    countIteration();
    if (control->takesBack) {
      control->sinceRestart = 0;
      control->momentum = 0;
      return;
    }
    const int k = control->sinceRestart++;
    control->momentum = accelerated && !last ? float(k) / float(k + 3) : 0.0f;
    control->objective = sums->objective;
  }
};

}  // namespace weir::detail
