// What AcceleratedSolver's iterations report of themselves, and what decides on the device how they go on,
// so that nobody waits for it.
#pragma once

#include <cstdint>

namespace weir {

struct SolverControl {
  int done = 0;          // of this step: whether to make no more iterations
  int met = 0;           // whether the tolerance is met
  int iterations = 0;    // of this step
  int sinceRestart = 0;  // of the acceleration
  int takesBack = 0;     // whether this iteration takes back what acceleration made of the last
  float momentum = 0;    // share of the last change that the next one goes on with; 0: the next is plain
  double objective = 0;  // the least so far
  // Of conjugate gradients (conjugate.h).
  double slope = 0;     // -z·g of the last iteration, m²
  double trial = 0;     // the length at which the next step is tried; 0: nothing is known yet
  double length = 0;    // of the last step
  double part = 0;      // of the trial's length, that the last step has gone
  int withoutGain = 0;  // iterations on end that have not lowered the objective
  int far = 0;          // whether λ at its end has to be summed anew
  // Of all steps.
  std::int64_t steps = 0, passes = 0, total = 0;
  int max = 0;
  int notConverged = 0;  // steps that ended before the tolerance was met, the last one not counted
  // Of the way to the predicted positions, see the class comment of AcceleratedSolver.
  int stages = 1;           // of this step
  float stride = 0;         // s; what a stage goes on by, over the velocity
  int stage = 1;            // of this step, from 1 on
  int repeats = 0;          // of this stage, because particles have come far since the search
  int finals = 0;           // passes that the last stage has had, without repeats
  int begun = 0;            // passes of this step
  int advance = 0;          // by how many stages the next pass goes on
  int over = 0;             // whether there is no next pass
  int surplus = 0;          // whether the present pass began when all was over
  int maxStages = 1;        // of all steps
  std::int64_t staged = 0;  // stages of all steps
};

}  // namespace weir
