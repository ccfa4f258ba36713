// The numbers that describe a fluid and its discretisation; all modules of a fluid share them.
#pragma once

#include <array>
#include <optional>

#include "framework/base/api.h"
#include "framework/graph/param_types.h"
#include "nodes/particle_fluid/spiky_kernel.h"

namespace WEIR_API weir {

/// What the kernel's normalisation s makes exact.
enum class Calibration { kPacking, kLattice };
template <>
struct EnumNames<Calibration> {
  static constexpr std::array<EnumName, 2> kNames{
      EnumName{"packing", "A settled fluid holds one particle per spacing cubed: no volume is lost at rest."},
      EnumName{
          "lattice",
          "A cubic lattice has rest density, as in the authors' code; fluid loses volume as it settles."}};
};

struct FluidConstants {
  float spacing = 0;         ///< d, m
  float supportRadius = 0;   ///< H, m
  float contact = 0;         ///< m: how near to a solid given by signed distance a particle may come
  float wallRadius = 0;      ///< H_w, m: the kernel's radius where it is integrated over solids
  float wallFactor = 0;      ///< a·s, what such integrals are multiplied by
  float restDensity = 0;     ///< ρ0, kg/m³
  float particleVolume = 0;  ///< V0 = d³, m³
  float particleMass = 0;    ///< m = ρ0·V0, kg
  float bulkModulus = 0;     ///< K', Pa: what the energy per particle is in proportion to
  float stiffened = 1;       ///< K'/K, how much stiffer that is than the fluid that was asked for
  float calibration = 0;     ///< s
  SpikyKernel kernel;

  /// Speed of sound squared, c² = K'/ρ0, m²/s².
  float soundSpeedSquared() const { return bulkModulus / restDensity; }
};

/// s = 1 / Σ V0·W₁ over the cubic lattice of spacing d, centre included, for H = supportRatio·d.
double latticeCalibration(double supportRatio);

/// s such that a settled fluid has rest density at one particle per d³: the lattice value times a measured
/// factor, interpolated between support ratios 1.1 and 3.
double packingCalibration(double supportRatio);

/// γ = dlnλ/dlnn of settled fluid, n being particles per volume. Squeezed evenly by 1/n, fluid that rests at
/// a support ratio q is fluid that rests at q·n^⅓ on a smaller scale, so γ = 1 − ⅓·dlns/dlnq, by differences
/// of packingCalibration. Below q = 1.2, where it vanishes, that of 1.2.
double settledResponse(double supportRatio);

/// K'/K. Under pressure λ − 1 = γ·δn/n, and the energy V0·K'/2·(λ − 1)² per particle makes
/// p = n·K'·V0·(λ − 1)·dλ/dn = γ²·K'·δn/n, so settled fluid yields like one of bulk modulus γ²·K'. With the
/// packing calibration this factor, max(1, (γ(1.5)/γ)²), keeps fluid of small supports from being softer than
/// that of the usual one; it is 1 from a support ratio of 1.5 on, and with the lattice calibration.
double stiffening(double supportRatio, Calibration calibration);

/// What stands for the fluid behind a wall: Ψ = a·Φ, Φ being the integral over the solid of the kernel with
/// radius H_w. λ gains Ψ, and as all forces are the gradient of one energy, a wall pushes with Ḃ·∇Ψ.
struct WallKernel {
  double radius;  ///< H_w, spacings
  double factor;  ///< a
};

/// An integral of a convex kernel over a half-space is more than the sum over particles that fill it. With
/// H_w in place of H, Φ of a plane at d/2 is what the lattice behind it would add to λ (with the packing
/// calibration and a support ratio below 1.5 less, as the neighbours of settled fluid in the bulk add less
/// than those at 1.5).
///
/// A wall pushes by its own side's Ḃ alone, where mirrored fluid would push by that of both. In continuous
/// fluid a = 1 would make λ right and a = 2 the pressure; a is in between, such that settled water
/// has its volume: layers at walls lie a little denser in pressure, and nearer to the wall, than others.
WallKernel wallKernel(double supportRatio, Calibration calibration);

/// How near to a solid given by signed distance particles may come, in spacings. The pressure keeps settled
/// fluid further away; this is for what is fast, and for single particles, which pressure does not hold.
inline constexpr float kContactRatio = 0.3f;

/// Room for the neighbours of one particle, a multiple of 8.
int neighborCapacity(double supportRatio);

FluidConstants makeFluidConstants(float spacing, float supportRatio, float restDensity, float bulkModulus,
                                  Calibration calibration);

}  // namespace weir
