#include "nodes/particle_fluid/modules/pbf.h"

namespace weir {

void Pbf::validate() const {
  if (form == PbfForm::kTextbook) return;
  for (const Property* property :
       {static_cast<const Property*>(&epsilon), static_cast<const Property*>(&artificialPressure)})
    if (property->isSet())
      throw sceneError(property->name() + " is given for the form \"unnormalized\"",
                       "only with \"form\": \"textbook\"")
          .inParameter(property->name());
}

void Pbf::report(NodeReport& report) {
  report.statistics["solver_iterations"] = iterations.get();
}

}  // namespace weir
