// Where a step of AcceleratedSolver with a tolerance goes between its iterations: in stages along the way to
// the predicted positions, and to searches for neighbours where the iterations have led. See the class
// comment.
#pragma once

#include "framework/compute/reductions.h"
#include "nodes/particle_fluid/displacement.h"
#include "nodes/particle_fluid/modules/accelerated_control.h"

namespace weir::detail {

struct BeginStep {
  SolverControl* control;
  const float* farthest;  // null where all is gone at once
  float dt;
  float stage;  // m, the longest way of a stage
  int max;      // stages

  WEIR_HD void operator()(std::int64_t) const {
    if (control->steps > 0 && !control->met) ++control->notConverged;
    control->iterations = 0;
    ++control->steps;
    control->stage = 1;
    control->repeats = control->finals = control->begun = control->advance = control->over = 0;
    const float stages = farthest != nullptr ? ceilf(sqrtf(*farthest) / stage) : 1.0f;
    control->stages = stages > float(max) ? max : stages > 1 ? int(stages) : 1;
    control->stride = dt / float(control->stages);
    control->staged += control->stages;
    if (control->stages > control->maxStages) control->maxStages = control->stages;
  }
};

struct SquareOfWay {
  float dt;
  ArrayView<const Vec3f> velocities;

  WEIR_HD float operator()(std::int64_t i) const {
    const Vec3f way = dt * velocities[i];
    return isFinite(way) ? dot(way, way) : 0.0f;
  }
};

/// From the predicted positions back to where the first stage goes.
struct GoBack {
  const SolverControl* control;
  ArrayView<const Vec3f> velocities;
  ArrayView<Vec3f> positions;

  WEIR_HD void operator()(std::int64_t i) const {
    if (control->stages > 1) positions[i] -= float(control->stages - 1) * control->stride * velocities[i];
  }
};

/// With the neighbours of a new search.
struct BeginPass {
  SolverControl* control;

  WEIR_HD void operator()(std::int64_t) const {
    // Where there are stages, the lists of the first pass, made at the predicted positions, are of no use.
    const bool idle = control->stages > 1 && control->begun == 0;
    control->done = idle || control->over ? 1 : 0;
    control->surplus = control->over;
    ++control->begun;
    control->sinceRestart = 0;
    control->takesBack = 0;
    control->momentum = 0;
    control->withoutGain = 0;
    control->objective = 0;
    ++control->passes;
  }
};

/// To where the search shall look for neighbours: to the next stage, too.
struct MoveOut {
  const SolverControl* control;
  ArrayView<const Vec3f> displacement, velocities;
  ArrayView<Vec3f> carried, positions;

  WEIR_HD void operator()(std::int64_t i) const {
    carried[i] = displacement[i];
    positions[i] += displacement[i];
    if (control->advance) positions[i] += float(control->advance) * control->stride * velocities[i];
  }
};

/// Back to the predicted positions, in the order of the search.
struct MoveBack {
  ArrayView<const Vec3f> carried;
  ArrayView<Vec3f> displacement, positions;
  ArrayView<Vec4f> state;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i], u = carried[i];
    state[i] = {p.x, p.y, p.z, 0};
    displacement[i] = u;
    positions[i] = p - u;
  }
};

}  // namespace weir::detail
