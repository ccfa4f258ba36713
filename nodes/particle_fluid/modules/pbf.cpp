#include "nodes/particle_fluid/modules/pbf.h"

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

void Pbf::record(FluidStep& fluid) {
  if (recordObjective) objective_.measure(fluid, BulkEnergy(), tension, state_.view(), displacement_.view());
}

void Pbf::report(NodeReport& report) {
  if (recordObjective) objective_.report(report);
  report.statistics["solver_iterations"] = iterations.get();
}

}  // namespace weir
