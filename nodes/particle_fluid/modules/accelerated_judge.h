// How the iterations of AcceleratedSolver go on, decided on the device.
#pragma once

#include "framework/compute/parallel.h"
#include "nodes/particle_fluid/modules/accelerated_control.h"
#include "nodes/particle_fluid/solver_sums.h"

namespace weir::detail {

/// Whether to go on, and with which momentum: k/(k + 3) in the k-th iteration since the last restart.
struct Judge {
  SolverControl* control;
  const SolverSums* sums;
  Count count;
  double tolerance;  // below 0: never done
  double settled;    // m², of each particle; see JudgeState
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
    if (far && control->repeats < maxRepeats && !spent()) {
      ++control->repeats;
      control->advance = 0;
      return;
    }
    const int left = control->stages - control->stage;
    control->advance = spent() ? left : left > 0 ? 1 : 0;
    if (control->advance) {
      control->stage += control->advance;
      control->repeats = 0;
      return;
    }
    control->over = ++control->finals >= passes || sums->farthest <= nearest || spent() ? 1 : 0;
    // What lists that do not hold say of compression is not true.
    if (far) control->met = 0;
  }

  /// Whether the tolerance is met by the mean compression.
  WEIR_HD bool meets() const {
    const std::int64_t particles = count.get();
    return (particles > 0 ? sums->compression / double(particles) : 0.0) <= tolerance;
  }

  /// Whether the step has had all its iterations.
  WEIR_HD bool spent() const { return control->iterations >= maxIterations; }

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
    const bool givesUp = spent() && !control->takesBack;
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
