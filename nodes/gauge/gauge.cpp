#include "nodes/gauge/gauge.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/base/vec_value.h"
#include "framework/compute/dispatch.h"
#include "framework/particles/owned_particles.h"
#include "nodes/gauge/box_sums.h"
#include "nodes/gauge/near_particles.h"

namespace weir {

namespace {

/// What attributes of the particles say, if there are such.
void addAttributes(const Particles& particles, double density, double pressure, Value& statistics) {
  if (hasScalar(particles, "density")) statistics["density"] = density;
  if (hasScalar(particles, "pressure")) statistics["pressure"] = pressure;
}

void reportPoint(const Particles& particles, const Vec3f& at, Value& statistics) {
  const LocalMatter found = NearParticles(particles.set().device(), particles, at, at).at(0);
  statistics["filled"] = found.filled;
  if (found.filled == 0) return;
  statistics["velocity"] = toValue(found.velocity);
  addAttributes(particles, found.density, found.pressure, statistics);
}

void reportLine(const Particles& particles, const Vec3f& from, const Vec3f& to, Value& statistics) {
  const NearParticles near(particles.set().device(), particles, from, to);
  const FluidOnLine found = fluidOnLine(near, length(to - from), particles.material.spacing);
  statistics["height"] = found.height;
  statistics["length"] = found.length;
}

void reportBox(const Particles& particles, const Aabb& box, Value& statistics) {
  Device& onDevice = particles.set().device();
  BoxSums sums;
  if (particles.set().bound() > 0) {
    Array<BoxSums> found(onDevice, 1);
    dispatch(onDevice, [&](auto& device) { sumBox(device, particles, box, found.data()); });
    sums = found.toHost().front();
  }
  const Vec3f size = box.hi - box.lo;
  statistics["particles"] = sums.particles;
  statistics["volume"] = sums.volume;
  statistics["filled"] = sums.volume / (double(size.x) * double(size.y) * double(size.z));
  statistics["mass"] = sums.mass;
  statistics["kinetic_energy"] = sums.kineticEnergy;
  if (sums.mass > 0) statistics["velocity"] = toValue((1 / sums.mass) * sums.momentum);
  if (sums.volume > 0)
    addAttributes(particles, sums.density / sums.volume, sums.pressure / sums.volume, statistics);
}

}  // namespace

void Gauge::validate() const {
  if (shape == GaugeShape::kLine && !(length(end.get() - position.get()) > 0))
    throw sceneError("the line has no length, as end is where position is", "an end elsewhere");
  if (shape == GaugeShape::kPlane && !(length(normal.get()) > 0))
    throw sceneError("the normal is 0", "a vector of any length but 0").inParameter(normal.name());
  const Vec3f size = max.get() - min.get();
  if (shape == GaugeShape::kBox && !(size.x > 0 && size.y > 0 && size.z > 0))
    throw sceneError("the box has no volume, as min is not below max along every axis", "min below max");
}

void Gauge::join(Communicator& ranks) {
  ranks_ = &ranks;
}

/// What passes the plane close to a face would be seen from one side of it only.
void Gauge::checkPlane() const {
  constexpr float kReach = 2;  // spacings
  const Period& period = particles->period;
  const Vec3f along = (1 / length(normal.get())) * normal.get();
  const float reach = kReach * particles->material.spacing;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr float kStraight = 1e-4f;
    if (!period.along(axis) || std::abs(along[axis]) < kStraight) continue;
    const float from = position.get()[axis] - period.lo[axis];
    if (std::abs(along[axis]) < 1 - kStraight || from < reach || from > period.size[axis] - reach)
      throw sceneError(
          "the plane meets the joined faces of a periodic domain",
          fmt::format("a plane along these faces, at least {:.4g} m from them, or across them", reach))
          .inParameter(position.name());
  }
}

void Gauge::reset(const SetupContext& context) {
  if (shape == GaugeShape::kPlane && particles.linked()) checkPlane();
  flow_ = Array<double>(context.device, 2);
  flow_->fillZero();
}

void Gauge::step(const StepContext& context) {
  if (shape == GaugeShape::kPlane) measureFlow(context.dt);
}

void Gauge::measureFlow(double dt) {
  Particles present = *particles;
  auto* const shared = dynamic_cast<OwnedParticles*>(&particles.links().front()->node());
  if (shared != nullptr) present.assign(shared->owned());
  Communicator* const ranks = shared != nullptr ? ranks_ : nullptr;
  // A rank without particles sums with the others.
  if (present.set().bound() == 0 && ranks == nullptr) return;
  dispatch(present.set().device(), [&](auto& device) { flowOn(device, present, ranks, dt); });
}

void Gauge::report(NodeReport& report) {
  if (flow_->empty() || !particles->exist()) return;
  if (shape == GaugeShape::kPoint) reportPoint(*particles, position, report.statistics);
  if (shape == GaugeShape::kLine) reportLine(*particles, position, end, report.statistics);
  if (shape == GaugeShape::kBox) reportBox(*particles, {min, max}, report.statistics);
  if (shape != GaugeShape::kPlane) return;
  const std::vector<double> flow = flow_->toHost();
  report.statistics["flow_rate"] = flow[0];
  report.statistics["volume"] = flow[1];
}

}  // namespace weir
