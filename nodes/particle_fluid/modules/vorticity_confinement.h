// Vorticity confinement: gives eddies back what the discretisation takes from them. Fedkiw et al. (2001),
// with the particle sums of Macklin and Müller (2013), Eq. 15 and 16:
//
//   ω_i = Σ_j |W'(r_ij)|/r_ij·(x_j − x_i) × (v_j − v_i) / N_i,     N_i = (1/3)·Σ_j |W'(r_ij)|·r_ij
//   η_i = Σ_j |W'(r_ij)|/r_ij·(|ω_j| − |ω_i|)·(x_j − x_i) / N_i
//   v_i ← v_i + dt·strength·d·(n_i × ω_i),                         n_i = η_i / (|η_i| + 0.01·|ω_i|/d)
//
// Division by N_i makes both derivatives of linear fields exact where neighbours lie evenly, so a rigid
// rotation has twice its spin; the published sums fall short by the kernel's normalisation. The factor d, as
// in Fedkiw's equation, lets the force fade as the resolution grows. The small term in n lets it vanish where
// vorticity is uniform and η has no direction. Energy is added and momentum is not conserved: it is an
// effect, not physics.
#pragma once

#include "framework/communication/on_ranks.h"
#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace weir {

class VorticityConfinement final : public FluidModule, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{
      "VorticityConfinement", kFamily,
      "Strengthens eddies, and shows the vorticity; insert it after the module \"viscosity\".",
      "eddies, turbulence, swirl, curl"};
  const ModuleInfo& info() const override { return kInfo; }

  Param<float> strength{
      *this,
      "strength",
      1,
      {.unit = "1/s",
       .min = 0,
       .softMax = 20,
       .live = true,
       .doc = "Acceleration of an eddy's rim over spacing times vorticity. 0 only computes the vorticity."}};

  /// Adds the attribute "vorticity".
  void reset(FluidStep& fluid) override;
  void step(FluidStep& fluid) override {
    dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }
  double memory(const FluidRoom& room) const override {
    return ParticleSet::memoryOfAttribute(room.particles, AttributeType::kVec3);
  }

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);

  Attribute<Vec3f> vorticity_;  // of the fluid's particles
};

}  // namespace weir
