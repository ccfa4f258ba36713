// The step length α of a pressure solver: 1, or searched. The linear model may not take an objective E ≥ 0
// below zero, so α = min(1, E/|g·Δx|) with E_i = |x_i − x*_i|²/2 + (c·dt)²·B(λ_i) and its gradient g_i, of
// each particle or of all together.
#pragma once

#include "nodes/particle_fluid/pressure_problem.h"
#include "nodes/particle_fluid/pressure_solver.h"

namespace weir {

/// E_i, and |g_i·Δx_i| where a step is proposed.
struct Measure {
  BulkEnergy energy;
  float stiffness;  // (c·dt)²
  ArrayView<const Vec3f> displacement;
  ArrayView<const float> excess;
  ArrayView<const Vec4f> proposal;  // may be empty
  ArrayView<const Vec3f> searched;  // displacements at the search; all 0 if it is empty

  WEIR_HD SolverSums operator()(std::int64_t i) const {
    const Vec3f u = displacement[i];
    const float e = excess[i];
    const Vec3f way = searched.size > 0 ? u - searched[i] : u;
    return {e > 0 ? double(e) : 0.0, 0.5 * double(dot(u, u)) + double(stiffness) * double(energy.value(e)),
            proposal.size > 0 ? double(proposal[i].w) : 0.0, double(dot(way, way))};
  }
};

/// Δx of full length, and |g·Δx| = |g|²/divisor.
struct Propose {
  PushOf pushOf;
  ArrayView<const Vec3f> displacement;
  ArrayView<Vec4f> proposal;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    const auto at = pushOf(i);
    const auto descent = at.push - read(displacement, i);
    const auto step = descent / at.divisor;
    write(proposal, i, {step.x, step.y, step.z, dot(descent, step)});
  }
};

/// Δx of an iteration: Eq. 14 or, with a search, α times what was proposed.
struct StepOf {
  PushOf pushOf;
  StepLength length;
  Measure measure;
  const SolverSums* sums;

  /// Calls apply(k, u, Δx) for particle i, or for eight at once or one by one, u being the displacement.
  template <class Index, class Apply>
  WEIR_HD void operator()(Index i, const Apply& apply) const {
    if (length == StepLength::kFull) {
      const auto u = read(measure.displacement, i);
      apply(i, u, fullStep(i, u));
    } else {
      forEachOf(i, [&](std::int64_t k) { apply(k, measure.displacement[k], searchedStep(k)); });
    }
  }

  template <class Index, class T>
  WEIR_HD Vec3<T> fullStep(Index i, const Vec3<T>& u) const {
    const auto at = pushOf(i);
    pushOf.followWalls(i, at);
    return (at.push - u) / at.divisor;
  }

  WEIR_HD Vec3f searchedStep(std::int64_t i) const {
    const float alpha = lengthFrom(length == StepLength::kGlobal ? *sums : measure(i));
    const WallFieldView& walls = pushOf.walls;
    if (walls.share.size > 0) pushOf.followWalls(i, pushOf(i), alpha);
    return alpha * xyz(measure.proposal[i]);
  }

  WEIR_HD static float lengthFrom(const SolverSums& of) {
    return of.objective < of.slope ? float(of.objective / of.slope) : 1.0f;
  }
};

}  // namespace weir
