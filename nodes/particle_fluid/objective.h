// How well a solver has done after each of its iterations: the paper's objective (Eq. 7),
//
//   ψ = Σ_i [ m·|x_i − x*_i|²/(2·dt²) + K·V0·B(λ_i) ],
//
// where K·V0 is the paper's μ, and λ is clamped below at 1 unless the solver knows tension. It is what the
// relative error of Eq. 18 is made of. Measured on the device, summed in double, and read when someone asks.
#pragma once

#include "framework/base/api.h"
#include "nodes/particle_fluid/bulk_energy.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace WEIR_API weir {

class ObjectiveRecord {
 public:
  /// A new step, which measures at most `times` times. Forgets the step before.
  void begin(FluidStep& fluid, int times);
  /// ψ of particles at the xyz of `state` that were moved by `displacement` from where they were predicted.
  void measure(FluidStep& fluid, const BulkEnergy& energy, bool tension, ArrayView<const Vec4f> state,
               ArrayView<const Vec3f> displacement);
  /// Adds "objective_by_iteration" [J]: of the last step, before its first iteration and after each.
  void report(NodeReport& report) const;
  void save(const StateWriter& to) const;
  void restore(const StateReader& from);

 private:
  template <class Backend>
  void measureOn(Backend& device, FluidStep& fluid, const BulkEnergy& energy, bool tension,
                 ArrayView<const Vec4f> state, ArrayView<const Vec3f> displacement);

  Array<double> values_;
  int measured_ = 0;
};

}  // namespace weir
