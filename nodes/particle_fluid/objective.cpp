#include "nodes/particle_fluid/objective.h"

#include "framework/compute/dispatch.h"

namespace weir {

void ObjectiveRecord::begin(FluidStep& fluid, int times) {
  if (values_.data() == nullptr) values_ = Array<double>(fluid.device);
  values_.resizeDiscarding(times);
  measured_ = 0;
}

void ObjectiveRecord::measure(FluidStep& fluid, const BulkEnergy& energy, bool tension,
                              ArrayView<const Vec4f> state, ArrayView<const Vec3f> displacement) {
  WEIR_CHECK(measured_ < values_.size());
  dispatch(fluid.device,
           [&](auto& device) { measureOn(device, fluid, energy, tension, state, displacement); });
  ++measured_;
}

void ObjectiveRecord::report(NodeReport& report) const {
  Value& list = report.statistics["objective_by_iteration"] = Value::array();
  if (measured_ == 0) return;
  for (const double psi : values_.toHost(measured_)) list.push(psi);
}

void ObjectiveRecord::save(const StateWriter& to) const {
  to.put("measured", values_, measured_);
}

void ObjectiveRecord::restore(const StateReader& from) {
  detail::getState(from, "measured", values_);
  measured_ = static_cast<int>(values_.size());
}

}  // namespace weir
