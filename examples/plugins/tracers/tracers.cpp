#include "tracers.h"

namespace tracers {

void VortexTracers::validate() const {
  if (!(length(axis.get()) > 0)) throw sceneError("the axis is 0", "a direction").inParameter(axis.name());
}

void VortexTracers::configure(const SetupContext&) {
  initial.request({.spacing = spacing, .supportRatio = 2});
}

void VortexTracers::estimate(const SetupContext&, MemoryNeeds& needs) {
  particles->maxCount = 0;
  for (std::size_t i = 0; i < initial.size(); ++i) particles->maxCount += initial[i].maxCount;
  particles->material.spacing = spacing;
  needs.particles = particles->maxCount;
  needs.add(ParticleSet::memoryFor(particles->maxCount) +
            ParticleSet::memoryOfAttribute(particles->maxCount, AttributeType::kFloat));
}

void VortexTracers::reset(const SetupContext& context) {
  set_ = std::make_unique<ParticleSet>(context.device);
  ParticleSet& set = **set_;
  revolutions_ =
      set.add<float>({"revolutions", AttributeType::kFloat, "", "Turns about the axis since the start."});
  for (std::size_t i = 0; i < initial.size(); ++i) set.append(initial[i]);
  particles->material = {.spacing = spacing, .density = {}, .volume = {}};
  particles->assign(set);
  drift(context.device, 0);  // gives them their velocities
}

void VortexTracers::step(const StepContext& context) {
  drift(context.device, context.dt);
}

void VortexTracers::drift(Device& onDevice, double dt) {
  if ((*set_)->bound() > 0)
    dispatch(onDevice, [&](auto& device) { driftOn(device, static_cast<float>(dt)); });
}

void VortexTracers::report(NodeReport& report) {
  report.statistics["tracers"] = particleCount();
}

}  // namespace tracers
