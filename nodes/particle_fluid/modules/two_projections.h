// Velocities and positions made incompressible one beside the other, so that water at rest under pressure has
// no stiffness against shear and small waves hardly lose height (engineering/jelly.md). In the place of the
// module "solver". It waits for the device every few iterations.
//
// At the positions x with which a step begins, x* − dt·v*, with r = x_j − x_i and a_ij = V0·|W'|/r, to which
// walls add what they mirror (projection_mirrors.h):
//
//   M_i = Σ_j a·r⊗r + Σ k·y·n⊗n,   N_i = M_i⁻¹,
//   L_i = (Σ_j a·(v_j − v_i)⊗r + Σ k·(n·(v_i − v_w))·n⊗n)·N_i,   D_i v = tr L_i
//
// are the velocities' gradient and divergence, exact for those that are linear in space and slip along walls:
// planes at a distance y with the normal n, the velocity v_w and a weight k (projection_walls.h). Velocities
// v* are smoothed where they are not linear, which is what the packing's own noise is,
//
//   v ← v* + smoothing·Σ_j V0·W·(v_j − v_i − ½·(L_i + L_j)·r),
//
// and projected: v ← v + Dᵀq with q = dt·p/ρ0 ≥ 0, D·v ≥ −s and one of both equal, by conjugate gradients in
// the particles that bear pressure. s lets fluid below rest density close up. A projection along Dᵀ takes
// kinetic energy away only. The stress of these forces is isotropic, whatever the pressures, as N is the
// inverse of M. What stands between a particle and a wall the wall carries, w being Σ k·(n·N·n)·n over its
// planes: before they are projected, velocities gain w·c for each, c = −y·n·(dt·g), but at least −q and at
// most q of the last step. Without that a wall would push by the pressure at the particle, a part of a
// spacing away from it. Then x = x + dt·v, and positions go towards λ ≤ 1 by an iteration of Pbf (Macklin and
// Müller 2013, Eq. 8 to 11), which leaves velocities alone. Momentum is kept but for what walls take. Bodies
// are part of the projection (projection_bodies.h), and stand still for the correction.
#pragma once

#include "framework/base/clamped.h"
#include "framework/communication/on_ranks.h"
#include "framework/compute/dispatch.h"
#include "framework/solids/free_body.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/modules/projection_sums.h"
#include "nodes/particle_fluid/own_wall_factor.h"

namespace weir {

struct ProjectionPacking;
namespace projection {
struct BodiesAtParticles;
}

class TwoProjections final : public FluidModule, public OnRanks, public OwnWallFactor {
 public:
  static constexpr ModuleInfo kInfo{
      "TwoProjections", kFamily,
      "Keeps the fluid incompressible without stiffness against shear, for calm water and waves: velocities "
      "by a consistent operator, positions beside them; takes the place of the solver, with a "
      "support_ratio of 1.8 or more.",
      "incompressible, pressure, solver, divergence, waves, calm, damping, ISPH"};
  const ModuleInfo& info() const override { return kInfo; }

  Param<float> tolerance{
      *this,
      "tolerance",
      1e-5f,
      {.min = 1e-7,
       .max = 1,
       .softMax = 1e-3,
       .live = true,
       .doc = "Iterate until volumes would change by no more than this share in a step, root of the mean "
              "square."}};
  Param<int> maxIterations{
      *this,
      "max_iterations",
      200,
      {.min = 1,
       .max = 10000,
       .live = true,
       .doc = "The most in a round; a step has up to six, as pressure comes to other particles."}};
  Param<float> smoothing{
      *this,
      "smoothing",
      1,
      {.min = 0,
       .max = 1,
       .live = true,
       .doc = "Share of what is not linear in velocities that a step takes away. 0.3 keeps more of short "
              "waves and is less calm, 0 boils."}};

  /// What water in tanks of 8 to 16 spacings needs to stand within 0.5 % as high as it should, measured at
  /// supports from 1.8 to 2.4 spacings (engineering/jelly.md). λ would be right in continuous fluid with 1.
  float wallFactor(float supportRatio) const override {
    return 1.037f - 0.065f * (clamped(supportRatio, 1.8f, 2.4f) - 2);
  }
  /// Adds the attribute "projection_pressure".
  void reset(FluidStep& fluid) override;
  /// Of a support with too few neighbours.
  void warn(const FluidOutlook& outlook) const override;
  /// Waits for the device every few iterations.
  void step(FluidStep& fluid) override {
    dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }
  void report(NodeReport& report) override;
  double memory(const FluidRoom& room) const override;

  struct Record {
    std::int64_t iterations = 0, steps = 0, unfinished = 0;
  };

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);
  /// Of the beginning of the step.
  template <class Backend>
  void findMoments(Backend& device, FluidStep& fluid);
  template <class Backend>
  void smooth(Backend& device, FluidStep& fluid);
  /// Adds what pressure changes to u_; leaves q in pressure_.
  template <class Backend>
  void project(Backend& device, FluidStep& fluid);
  /// One round of conjugate gradients; whether it has ended by the tolerance.
  template <class Backend>
  bool iterate(Backend& device, FluidStep& fluid, double squares);
  /// Writes two sums, before it and after it, in device memory; nothing else if the round is done.
  template <class Backend>
  void iterateOnce(Backend& device, FluidStep& fluid, double enough, projection::ProjectionSums* before);
  /// D·Dᵀ of what is in `of`, into product_; push_ is Dᵀ of it, and what the bodies get is their change.
  template <class Backend>
  void apply(Backend& device, FluidStep& fluid, Count count, const Array<float>& of);
  /// The bodies' changes by the sums of what their pairs with particles give; adds them to `divergence`.
  template <class Backend, class Sum>
  void changeBodies(Backend& device, FluidStep& fluid, const Sum& sum, Array<float>& divergence);
  /// Bodies get what they carry; also finds what they add to the operator's diagonal.
  template <class Backend>
  void carryBodies(Backend& device, FluidStep& fluid);
  /// Bodies go on with the velocities that the projection has given them, and are told of it.
  template <class Backend>
  void moveBodies(Backend& device, FluidStep& fluid);
  projection::BodiesAtParticles bodiesOf(FluidStep& fluid);
  /// Moves particles towards λ ≤ 1.
  template <class Backend>
  void correct(Backend& device, FluidStep& fluid);
  /// What the passes know of the particles, by the tensors that there are.
  ProjectionPacking packingOf(FluidStep& fluid);
  void fit(FluidStep& fluid);

  State<Record> record_{*this, "projection"};
  Attribute<float> pressure_;      // Pa
  Array<Vec4f> state_, weighted_;  // position; and the multiplier of corrections
  Array<Vec3f> wallDistances_;     // NearWalls
  Array<float> wallKeys_;
  Array<Vec3f> diagonal_, off_;           // of N: xx, yy, zz and xy, xz, yz
  Array<Vec3f> wall_;                     // w, see above
  Array<Vec4f> wallOfPair_;               // of BodiesAtParticles, where bodies move
  Array<Twist> wrenches_;                 // of each solid
  Array<Vec3f> u_, push_, displacement_;  // the last from x*; at first what walls carry
  Array<Vec3f> rowX_, rowY_, rowZ_;       // of L
  Array<float> q_, room_, source_, residual_, direction_, product_, preconditioner_;
  static constexpr int kTogether = 8;       // iterations that the host does not look at one by one
  Array<projection::ProjectionSums> sums_;  // two of each of them
  Array<int> active_;                       // one: particles that the passes of an iteration have
};

}  // namespace weir
