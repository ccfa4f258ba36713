#include "nodes/particle_fluid/modules/viscosity_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

double viscosityFactor(double supportRatio) {
  struct Point {
    double ratio, factor;
  };
  // Such that free cylinders of settled fluid that are twisted lose their motion at the rate of the closed
  // form, in the limit of many particles (ViscositySolver.TwistedCylinder… in the tests).
  constexpr Point kMeasured[] = {{1.5, 1.45}, {1.6, 1.263}, {1.7, 1.19},  {1.8, 1.22},
                                 {2, 1.112},  {2.2, 1.072}, {2.5, 1.034}, {3, 1.01}};
  const Point* above = std::upper_bound(std::begin(kMeasured), std::end(kMeasured), supportRatio,
                                        [](double ratio, const Point& p) { return ratio < p.ratio; });
  if (above == std::begin(kMeasured)) return above->factor;
  if (above == std::end(kMeasured)) return std::prev(above)->factor;
  const Point &low = *std::prev(above), &high = *above;
  return low.factor + (high.factor - low.factor) * (supportRatio - low.ratio) / (high.ratio - low.ratio);
}

void ViscositySolver::reset(FluidStep& fluid) {
  change_ = fluid.particles.add<Vec3f>({"viscous_change", AttributeType::kVec3, "m/s",
                                        "Change of the velocity by viscosity in the last step."});
  control_ = Array<ViscosityControl>(fluid.device);
  control_->assign(std::vector<ViscosityControl>{ViscosityControl{}});
  sums_ = Array<ViscositySums>(fluid.device);
  sums_.resize(1);
  controlSeen_.emplace(fluid.device);
  steps_ = 0;
  warnOfSupport(fluid);
}

void ViscositySolver::warnOfSupport(FluidStep& fluid) const {
  constexpr float kMinSupport = 1.5f;  // spacings
  constexpr float kRounding = 1e-3f;
  const float support = fluid.constants.supportRadius / fluid.constants.spacing;
  if (enabled() && viscosity > 0 && support < kMinSupport - kRounding)
    fluid.time.log.warn(fmt::format(
        "module '{}': viscosity needs a support_ratio of at least {}; at {:.4g} the pairs are too "
        "few to resist shear, and the fluid is thinner than it should be",
        name(), kMinSupport, support));
}

void ViscositySolver::step(FluidStep& fluid) {
  // Fluid that finds its rest before the start flows, however viscous it is.
  if (fluid.walls.still || !(viscosity > 0)) return;
  refuseBodies(fluid);
  dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
}

void ViscositySolver::refuseBodies(const FluidStep& fluid) {
  for (const Solid* solid : fluid.walls.solids)
    if (solid->isMovedByForces() && solid->surface().slip < 1)
      throw sceneError("viscous fluid does not drag a RigidBody yet",
                       "\"slip\": 1 of the RigidBody, or Xsph");
}

bool ViscositySolver::isDone(const FluidStep& fluid) {
  std::optional<ViscosityControl> seen;
  if (fluid.divided == nullptr)
    seen = controlSeen_->poll();
  else if (controlSeen_->pending())
    seen = controlSeen_->wait();  // ranks end together
  return seen && seen->steps == steps_ && seen->done != 0;
}

void ViscositySolver::report(NodeReport& report) {
  if (control_->size() == 0) return;
  const ViscosityControl control = control_->toHost().front();
  const double steps = std::max<double>(1, double(control.steps));
  report.statistics["viscosity_iterations_mean"] = double(control.total) / steps;
  report.statistics["viscosity_iterations_max"] = control.max;
  report.statistics["viscosity_steps_not_converged"] = control.notConverged;
}

double ViscositySolver::memory(const FluidRoom& room) const {
  return bytesOfArrays(room.particles, residual_, direction_, image_, wallDiagonal_, wallRest_, wallPush_) +
         ParticleSet::memoryOfAttribute(room.particles, AttributeType::kVec3);
}

}  // namespace weir
