// Conjugate gradients for the problem of AcceleratedSolver (pressure_problem.h), nonlinear and with a
// preconditioner (E. Polak, G. Ribière 1969; J. Nocedal, S. Wright 2006, chapter 5).
//
// With u the displacement, g = u − push the gradient of Σ E, and z = −g/divisor, kept out of solids, an
// iteration goes along
//
//   p_k = z_k + β·p_k−1,   β = max(z_k·(g_k−1 − g_k)/(z_k−1·(−g_k−1)), 0)
//
// by the length α where the slope of Σ E along p is 0, on the straight line through the slopes at u and at
// u + α'·p, where α' is the last iteration's length. λ at that place is summed over neighbours anew; at u +
// α·p it is taken from the straight line, too, unless α and α' differ much. So an iteration takes two sums
// over neighbours, as a plain one does. Plain iterations are short, as each particle moves as if its
// neighbours did not move along: α is 5 to 20.
//
// The divisor is one for all particles (commonDivisor), so what pairs push each other by stays opposite, and
// momentum is kept however few the iterations are. Each particle's own, that of a plain iteration, takes as
// many.
//
// Where Σ E has risen, the step is taken back, and the next one is along z and shorter. The displacement by
// walls of meshes is share·∇Φ (wall_field.h), and its share goes along lines of its own.
#pragma once

#include <cstdint>
#include <utility>

#include "framework/base/vec.h"
#include "framework/compute/array.h"
#include "nodes/particle_fluid/solver_sums.h"

namespace weir {

struct FluidStep;

/// Sums over all particles, by which a direction is chosen, m².
struct DirectionSums {
  double slope = 0;    ///< −z·g
  double turned = 0;   ///< −z·g', g' being the last gradient
  double forward = 0;  ///< p'·g, of the last direction p'
};

struct AddDirectionSums {
  WEIR_HD DirectionSums operator()(const DirectionSums& a, const DirectionSums& b) const {
    return {a.slope + b.slope, a.turned + b.turned, a.forward + b.forward};
  }
};

/// Slopes of Σ E along a direction: where the step starts, and where it is tried.
struct LineSums {
  double atStart = 0, atTrial = 0;
};

struct AddLineSums {
  WEIR_HD LineSums operator()(const LineSums& a, const LineSums& b) const {
    return {a.atStart + b.atStart, a.atTrial + b.atTrial};
  }
};

/// For kernels. One element each particle, but for those of walls, which are empty without meshes.
struct ConjugateView {
  ArrayView<Vec3f> direction;            ///< p
  ArrayView<Vec3f> tried;                ///< displacement: u + z, then u + α'·p, then where the step began
  ArrayView<Vec3f> gradient, previous;   ///< g, and that of the last iteration
  ArrayView<float> excess, triedExcess;  ///< λ − 1 at u and at `tried`
  ArrayView<float> share, shareChange;   ///< of walls, in p and in z
  // The displacement by walls, as `held` of AcceleratedSolver, and what of it is in p and in z; empty without
  // meshes where no boundary reports forces.
  ArrayView<Vec3f> held, heldDirection, heldChange;
};

/// The memory of it.
class ConjugateDirections {
 public:
  /// 56 bytes a particle, 8 more with walls of meshes, and 24 more with these or with boundaries that report
  /// forces.
  /// Contents are undefined.
  void reserve(FluidStep& fluid);
  /// Bytes of that.
  double memoryFor(double particles, bool walls, bool held) const;
  /// Gives it back.
  void release();
  ConjugateView view();
  /// The gradient takes the place of that of the last iteration.
  void turn() { std::swap(gradient_, previous_); }

  Array<DirectionSums> directionSums;
  Array<LineSums> lineSums;

 private:
  Array<Vec3f> direction_, tried_, gradient_, previous_;
  Array<float> excess_, triedExcess_, share_, shareChange_;
  Array<Vec3f> heldDirection_, heldChange_;
};

}  // namespace weir
