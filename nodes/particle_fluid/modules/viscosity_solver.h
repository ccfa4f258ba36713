// The viscosity of a Newtonian fluid, in Pa·s, implicit.
//
// With v* the velocities after the other forces, and before pressure, those after a step minimise
//
//   Σ_i m/2·|v_i − v*_i|² + dt/2·Σ_ij k_ij·((v_i − v_j)·x̂_ij)²/2
//   k_ij = F·V0²·μ_ij·2(d + 2)·|W'(r_ij)|/r_ij,   d = 3
//
// a drag on each pair along its line (Cleary and Monaghan 1999; Weiler et al. 2018). Over a field of
// velocities without divergence the sum over evenly spread neighbours is μ·∇²v. The positions are those at
// the beginning of the step, so linear and angular momentum are kept; kinetic energy never grows. A free
// surface has no neighbours beyond it and feels no stress. Walls drag each particle along themselves
// (viscous_walls.h), and solids given by meshes feel the opposite.
//
// W is the spiky kernel with an integral of 1. F (viscosityFactor) is 1 for many neighbours; it makes up for
// the sums over few, and for the disorder of settled fluid, in which velocities deviate from those of the
// mean flow where that costs less. μ_ij is the harmonic mean of those of the particles: what is sheared
// across a surface between two fluids has the same stress on both sides.
//
// The minimum is where (1 + K)·v = v*, with a symmetric K of pairs. Conjugate gradients find v − v*, from
// that of the last step on, to a tolerance. They are not preconditioned: all residuals then are forces of
// pairs, so momentum is kept whatever the tolerance, and angular momentum far better than to it. The identity
// bounds the spectrum from below, so scaling by the diagonal, which is nearly the same for all, would gain
// little.
//
// It stands before the pressure, as gravity, which it balances in slow flow, then acts within its step; and
// the pressure has the last word on density. Positions, which the module "predict" has moved by v*, follow.
// What pressure changes, dt·|∇p|/ρ0, is smoothed in the next step only.
#pragma once

#include <optional>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/compute/readback.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/modules/viscous_walls.h"

namespace WEIR_API weir {

/// F for settled fluid.
double viscosityFactor(double supportRatio);

/// What conjugate gradients sum over all particles; m²/s².
struct ViscositySums {
  double residual = 0;   ///< |r|²
  double change = 0;     ///< |v − v*|²
  double speed = 0;      ///< |v*|²
  double curvature = 0;  ///< p·(1 + K)·p
};

/// What is decided on the device.
struct ViscosityControl {
  double residual = 0;  ///< |r|² of the present iterate
  double speed = 0;
  float alpha = 0, beta = 0;
  int done = 0, iterations = 0;  ///< of this step
  // Of all steps.
  std::int64_t steps = 0, total = 0;
  int max = 0, notConverged = 0;
};

class ViscositySolver final : public FluidModule, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{
      "ViscositySolver", kFamily,
      "Viscosity in Pa·s, implicit, for any time step; insert it after the module \"walls\".",
      "viscous, thick, honey, oil, syrup, lava, glycerine, Newtonian"};
  const ModuleInfo& info() const override { return kInfo; }

  Param<float> viscosity{*this,
                         "viscosity",
                         1,
                         {.unit = "Pa*s",
                          .min = 0,
                          .max = 1e12,  // beyond it squares of forces leave the range of floats
                          .softMin = 0.001,
                          .softMax = 10000,
                          .live = true,
                          .animated = true,
                          .doc = "Dynamic viscosity: water has 0.001, olive oil 0.1, honey about 8."}};
  Param<float> tolerance{*this,
                         "tolerance",
                         1e-3f,
                         {.min = 0,
                          .max = 0.1,
                          .aboveMin = true,
                          .live = true,
                          .doc = "How exactly velocities are found: the residual over the change that "
                                 "viscosity makes in a step."}};
  Param<int> maxIterations{
      *this, "max_iterations", 1000, {.min = 1, .max = 100000, .live = true, .doc = "The most in a step."}};

  void reset(FluidStep& fluid) override;
  void step(FluidStep& fluid) override;
  void report(NodeReport& report) override;
  double memory(const FluidRoom& room) const override;

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);
  /// Of one too small to resist shear.
  void warnOfSupport(FluidStep& fluid) const;
  /// Throws a scene Error if forces move a solid that the fluid would drag.
  static void refuseBodies(const FluidStep& fluid);
  /// Finds the change.
  template <class Backend, class Drag>
  void solveOn(Backend& device, FluidStep& fluid, const Drag& drag, const WallDrag& walls,
               ArrayView<Vec3f> change);
  /// As far as the host has heard of it, without waiting.
  bool isDone(const FluidStep& fluid);

  Attribute<Vec3f> change_;  // v − v* of the last step
  Array<Vec3f> residual_, direction_, image_;
  Array<Vec3f> wallDiagonal_, wallRest_, wallPush_;
  Array<ViscositySums> sums_;
  State<Array<ViscosityControl>> control_{*this, "control"};
  std::optional<Readback<ViscosityControl>> controlSeen_;
  State<std::int64_t> steps_{*this, "steps"};  // begun, as ViscosityControl::steps
};

}  // namespace weir
