#include "nodes/particle_fluid/modules/pbf.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/graph/setting_warning.h"

namespace weir {

void Pbf::validate() const {
  if (form == PbfForm::kTextbook) {
    if (stepFactor.isSet())
      throw sceneError("a step is given for the form \"textbook\"", "only with \"form\": \"unnormalized\"")
          .inParameter(stepFactor.name());
    return;
  }
  for (const Property* property :
       {static_cast<const Property*>(&epsilon), static_cast<const Property*>(&artificialPressure)})
    if (property->isSet())
      throw sceneError(property->name() + " is given for the form \"unnormalized\"",
                       "only with \"form\": \"textbook\"")
          .inParameter(property->name());
}

void Pbf::warn(const FluidOutlook& outlook) const {
  if (form == PbfForm::kTextbook) return;
  // Its step over that of the textbook form.
  constexpr double kMin = 0.1, kMax = 1;
  const double scale = stepFactor;
  const FluidConstants& c = outlook.constants;
  const double step = scale * c.particleMass;
  if (step >= kMin * (1 - kSettingRounding) && step <= kMax * (1 + kSettingRounding)) return;
  outlook.warn(
      *this,
      fmt::format("at a spacing of {:.4g} m its steps are {:.2g} times those of the textbook form, so "
                  "they {}",
                  c.spacing, step, step < kMin ? "hardly act" : "overshoot"),
      fmt::format("\"form\": \"textbook\", a spacing from {:.2g} to {:.2g} m, or \"step\": {:.2g}",
                  std::cbrt(kMin / (scale * c.restDensity)), std::cbrt(kMax / (scale * c.restDensity)),
                  1 / c.particleMass));
}

void Pbf::record(FluidStep& fluid) {
  if (recordObjective) objective_->measure(fluid, BulkEnergy(), tension, state_.view(), displacement_.view());
}

void Pbf::report(NodeReport& report) {
  if (recordObjective) objective_->report(report);
  report.statistics["solver_iterations"] = iterations.get();
}

}  // namespace weir
