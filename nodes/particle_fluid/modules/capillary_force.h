// Surface tension in N/m, with an angle of contact, as a force on the surface (after Brackbill, Kothe and
// Zemach 1992, Morris 2000, and for walls Breinlinger et al. 2013):
//
//   a = (σ·κ + p)·δ·n/ρ0
//
// with the unit normal n into the fluid, the sum κ of the principal curvatures, positive for a drop, the
// density δ of area in 1/m, and the pressure p of the air;
// and v ← v + dt·a. It is normal to the surface and in proportion to its curvature alone, so the balance of
// fluid at rest gives Laplace's pressure whatever the layer of particles at the surface is like. With W the
// poly6 kernel of the fluid's support radius H,
//
//   g_i = Σ_j V0·∇_i W(r_ij) + Σ_w ∇C_w      gradient of the colour; solids, as half-spaces, count as fluid
//   n_i along W_ii·g_i + Σ_j W_ij·g_j        where that is steep; near solids turned to the angle of contact
//   δ_i = 2F·max(g_i·n_i, 0)                 near solids as if the surface went on within them
//
// Curvature is that of the least-squares fit of n_j − n_i = −S·(x_j − x_i) within the tangent plane, with the
// weights W_ij·δ_j: κ = tr S, and Gauss' curvature is det S. With M their mean over the neighbours, by the
// same weights, M + 3(M − M·M) takes their noise out and leaves waves that are long beside H as they are (the
// normals, the fit and the mean each take as much of them as M does). Particles lie below the surface, and
// the layers near it, stressed less along it than across, bear a share of the pressure that goes with H·κ;
// both are made up for by taking these curvatures for those of a surface at a depth of D, so that
//
//   κ ← (κ + 2D·det S)/(1 + D·κ + D²·det S)
//
// is that of the fluid's own, and at most 1/d. D and F (surfaceFit) are such that settled drops have
// Laplace's pressure. Single particles feel nothing, and threads and sheets no more than drops of two
// spacings do.
//
// Forces of a closed surface have no sum. What is left by disorder, some thousandths of the sum of their
// sizes, is taken away, by area, where the fluid meets no solids.
#pragma once

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace WEIR_API weir {

/// What settled drops were fitted with, by support ratio.
struct SurfaceFit {
  double depth;  ///< D, spacings
  double area;   ///< F
};
SurfaceFit surfaceFit(double supportRatio);

/// Sums over all particles, N/m³ and 1/m.
struct CapillarySums {
  double x = 0, y = 0, z = 0;  ///< of the force by volume
  double area = 0;             ///< of δ
};

class CapillaryForce final : public FluidModule, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{
      "CapillaryForce", kFamily,
      "Surface tension in N/m, with an angle of contact; insert it after the module \"viscosity\".",
      "drops, cohesion, wetting, capillary, contact angle, meniscus"};
  const ModuleInfo& info() const override { return kInfo; }

  Param<float> tension{
      *this,
      "tension",
      0.072f,
      {.unit = "N/m",
       .min = 0,
       .max = 1e9,  // beyond it forces leave the range of floats
       .softMax = 10,
       .live = true,
       .doc = "Of the surface: water 0.072, oil 0.03, mercury 0.49. Works from a support_ratio "
              "of 2; too much for dt makes the surface shake."}};
  Param<float> contactAngle{
      *this,
      "contact_angle",
      90,
      {.unit = "deg",
       .min = 0,
       .max = 180,
       .live = true,
       .doc = "Of the surface with solids, within the fluid: below 90 it wets them, above it beads."}};
  Param<float> airPressure{
      *this,
      "air_pressure",
      0,
      {.unit = "Pa",
       .min = 0,
       .max = 1e9,
       .softMax = 100,
       .live = true,
       .doc = "Pressure of the air on free surfaces; it holds those together that are hollow."}};

  /// Warns of a support too small for it.
  void reset(FluidStep& fluid) override;
  /// Of a tension that is too much for the step. The force is explicit, so σ·dt²/(ρ0·d³) has a bound.
  void warn(const FluidOutlook& outlook) const override;
  void step(FluidStep& fluid) override {
    if (tension > 0 || airPressure > 0) dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }
  double memory(const FluidRoom& room) const override {
    return bytesOfArrays(room.particles, gradient_, wall_, normal_, curvature_, smoothed_);
  }

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);
  template <class Backend>
  void findNormals(Backend& device, FluidStep& fluid);
  template <class Backend>
  void findCurvature(Backend& device, FluidStep& fluid);

  Array<Vec3f> gradient_;              // g, 1/m
  Array<Vec4f> wall_;                  // of the nearest solid: its normal, and how far away it is, m
  Array<Vec4f> normal_;                // n and δ, 1/m
  Array<Vec3f> curvature_, smoothed_;  // κ, Gauss' curvature and δ: in the end M·M and M of them
  Array<CapillarySums> sums_;          // one
};

}  // namespace weir
