#include "nodes/square_emitter/square_emitter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace weir {

void SquareEmitter::validate() const {
  if (stop.get() && *stop.get() < start) throw sceneError("stop is before start", "stop at or after start");
}

void SquareEmitter::reset(const SetupContext& context) {
  const auto request = particles.requested();
  if (!request)
    throw sceneError("the emitter is not linked to a fluid, so its particle spacing is unknown",
                     "a link from '" + particles.path() + "' to the emitters of a ParticleFluid");
  spacing_ = request->spacing;
  constexpr double kMostParticlesInLayer = 1e7;
  const double columns = std::max(1.0, std::round(double(width) / spacing_));
  const double rows = std::max(1.0, std::round(double(height) / spacing_));
  if (columns * rows > kMostParticlesInLayer)
    throw sceneError(fmt::format("a nozzle of {} x {} m at a spacing of {} m has {:.3g} particles in a layer",
                                 width.get(), height.get(), spacing_, columns * rows),
                     "at most 10 million particles in a layer");
  columns_ = static_cast<int>(columns);
  rows_ = static_cast<int>(rows);
  constexpr double kNoticeableRounding = 0.1;
  const double area = columns * rows * spacing_ * spacing_, asked = double(width) * height;
  if (std::abs(area / asked - 1) > kNoticeableRounding)
    context.log.warn(
        fmt::format("node '{}': the nozzle of {} x {} m is rounded to {} x {} particles of {} m, which "
                    "changes the flux by {:+.0f} %",
                    name(), width.get(), height.get(), columns_, rows_, spacing_, 100 * (area / asked - 1)));
  travel_ = 0;
  layers_ = emitted_ = 0;
  particles->count = 0;
  particles->positions = Array<Vec3f>(context.device);
  particles->velocities = Array<Vec3f>(context.device);
}

void SquareEmitter::step(const StepContext& context) {
  particles->count = 0;
  const double begin = std::max(context.time, start.get());
  const double end = std::min(context.time + context.dt, stop.get().value_or(context.time + context.dt));
  if (end <= begin || speed == 0) return;
  // Layer k passes the nozzle when the jet has travelled k spacings.
  const double travelled = travel_ + speed * (end - begin);
  const auto layersAfter = static_cast<std::int64_t>(std::ceil(travelled / spacing_));
  const std::int64_t inLayer = std::int64_t{columns_} * rows_;
  std::int64_t count = (layersAfter - layers_) * inLayer;
  if (maxParticles.get()) count = std::min(count, *maxParticles.get() - emitted_);
  if (count > 0) {
    // Where the first layer is at the beginning of the step: this far behind the nozzle.
    const double firstOffset = double(layers_) * spacing_ - travel_ + speed * (begin - context.time);
    particles->positions.resize(count);
    particles->velocities.resize(count);
    particles->count = count;
    dispatch(context.device, [&](auto& device) { emitOn(device, count, firstOffset); });
    emitted_ += count;
  }
  layers_ = layersAfter;
  travel_ = travelled;
}

void SquareEmitter::report(NodeReport& report) {
  report.statistics["particles_emitted"] = emitted_;
}

}  // namespace weir
