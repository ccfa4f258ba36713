#include "dfsph.h"

#include <algorithm>

namespace dfsph {

void Dfsph::reset(FluidStep& fluid) {
  density_ = divergence_ = {};
  pressure_ = fluid.particles.add<float>(
      {"pressure", AttributeType::kFloat, "Pa", "Pressure of the density solver."});
}

void Dfsph::fit(FluidStep& fluid) {
  const std::int64_t size = fluid.particles.capacity();
  const auto fitOne = [&](auto& array, std::int64_t length) {
    if (array.data() == nullptr) array = std::remove_reference_t<decltype(array)>(fluid.device);
    array.resizeDiscarding(length);
  };
  fitOne(state_, size);
  fitOne(next_, size);
  fitOne(displacement_, size);
  fitOne(source_, size);
  fitOne(diagonal_, size);
  fitOne(error_, size);
  fitOne(errorSum_, 1);
}

namespace {

void write(const SolverRecord& record, const std::string& name, NodeReport& report) {
  Value& of = report.statistics[name] = Value::object();
  of["error"] = record.error;
  of["max_error"] = record.maxError;
  of["iterations"] = double(record.iterations) / double(std::max<std::int64_t>(record.steps, 1));
  report.events.push_back({"steps in which the " + name + " did not reach its tolerance", record.unfinished});
}

}  // namespace

void Dfsph::report(NodeReport& report) {
  write(density_, "density_solver", report);
  write(divergence_, "divergence_solver", report);
}

}  // namespace dfsph
