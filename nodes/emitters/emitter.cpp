#include "nodes/emitters/emitter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/compute/dispatch.h"
#include "framework/graph/memory_estimate.h"
#include "framework/graph/setting_warning.h"
#include "framework/graph/state.h"
#include "framework/particles/flight.h"

namespace weir {

void Emitter::validate() const {
  if (stop.get() && *stop.get() < start) throw sceneError("stop is before start", "stop at or after start");
}

void Emitter::checkLayerSize(const SetupContext& context) const {
  const double size = layerSize(spacing_);
  if (!(size <= maxInLayer()))
    throw sceneError(fmt::format("an area of {:.4g} m² at a spacing of {} m has {:.3g} particles in a layer",
                                 area(), spacing_, size),
                     fmt::format("at most {:.0f} million particles in a layer", maxInLayer() * 1e-6));
  constexpr double kNoticeableRounding = 0.1;
  const double covered = size * spacing_ * spacing_;
  if (std::abs(covered / area() - 1) > kNoticeableRounding)
    context.log.warn(
        fmt::format("node '{}': the area of {:.4g} m² is rounded to {:.0f} particles of {} m, which changes "
                    "the flux by {:+.0f} %",
                    name(), area(), size, spacing_, 100 * (covered / area() - 1)));
}

void Emitter::warnOfSettings(const SetupContext& context) const {
  const std::string where = fmt::format("node '{}'", name());
  const double fastest = speed.max(start, stop.get().value_or(std::numeric_limits<double>::max()));
  const double travel = fastest * context.dt / spacing_;
  if (!context.stepsVary && travel > kMaxTravel * (1 + kSettingRounding))
    warnOfSetting(
        context.log, where,
        fmt::format("a flow of {:.4g} m/s moves {:.3g} spacings in a step of {:.3g} s", fastest, travel,
                    context.dt),
        fmt::format("a world.dt of at most {:.2g} s, or world.cfl", kMaxTravel * spacing_ / fastest));
  const double width = std::sqrt(area()) / spacing_;
  if (width < kMinSpacings * (1 - kSettingRounding))
    warnOfSetting(context.log, where,
                  fmt::format("the opening is {:.3g} spacings wide (the root of its area), so the jet is not "
                              "resolved",
                              width),
                  fmt::format("a spacing of at most {:.2g} m, or an area of at least {:.2g} m²",
                              std::sqrt(area()) / kMinSpacings, std::pow(kMinSpacings * spacing_, 2)));
}

void Emitter::estimate(const SetupContext& context, MemoryNeeds& needs) {
  const auto request = particles.requested();
  if (!request) return;  // reset() says so
  const double inLayer = layerSize(request->spacing);
  const double begin = start, end = std::min(context.end, stop.get().value_or(context.end));
  const double travel = end > begin ? double(speed.mean(begin, end)) * (end - begin) : 0;
  const auto limited = [&](double layers) {
    const double max = maxParticles.get() ? static_cast<double>(*maxParticles.get()) : inLayer * layers;
    return std::min(inLayer * layers, max);
  };
  // One layer more than fit in, as the first leaves at once; another for rounding over the steps.
  particles->maxCount = travel > 0 ? limited(std::ceil(travel / request->spacing) + 1) : 0;
  const double fastest = end > begin ? double(speed.max(begin, end)) : 0;
  needs.remedy = [](double) { return std::string(); };  // the fluid's spacing decides
  // Batches differ by a layer from step to step; arrays that grow are up to a quarter too long.
  const double atOnce = limited(std::ceil(fastest * context.dt / request->spacing) + 1);
  needs.add(bytesOfArrays(1.25 * atOnce, particles->positions, particles->velocities));
  constexpr int kInFluid = 2;  // batches that it carries on (inflow.h)
  needs.add(kInFluid * bytesOfArrays(atOnce, particles->positions, particles->velocities));
  needs.add(bytesOfArrays(inLayer * layersMade(), points_, directions_));
}

void Emitter::reset(const SetupContext& context) {
  const auto request = particles.requested();
  if (!request)
    throw sceneError("the emitter is not linked to a fluid, so its particle spacing is unknown",
                     "a link from '" + particles.path() + "' to the emitters of a ParticleFluid");
  spacing_ = request->spacing;
  checkLayerSize(context);
  warnOfSettings(context);
  seed_ = seedFor(context);
  const Layer layer = makeLayer(context, spacing_);
  points_ = Array<Vec3f>(context.device, layer.points);
  directions_ = Array<Vec3f>(context.device, layer.directions);
  inLayer_ = points_.size() / layer.layers;
  travel_ = layers_ = 0;
  emitted_ = 0;
  particles->count = 0;
  particles->positions = Array<Vec3f>(context.device);
  particles->velocities = Array<Vec3f>(context.device);
}

double Emitter::longestStep(const StepContext& next, double cfl) {
  const double begin = std::max(next.time, start.get());
  const double end = std::min(next.time + next.dt, stop.get().value_or(next.time + next.dt));
  const bool exhausted = maxParticles.get() && emitted_ >= *maxParticles.get();
  if (end <= begin || exhausted) return Node::longestStep(next, cfl);
  return timeToFly(cfl * spacing_, speed.max(begin, end), length(next.gravity));
}

void Emitter::step(const StepContext& context) {
  particles->count = 0;
  flow_ = {};
  const double begin = std::max(context.time, start.get());
  const double end = std::min(context.time + context.dt, stop.get().value_or(context.time + context.dt));
  if (end <= begin) return;
  const double flowSpeed = speed.mean(begin, end);
  if (flowSpeed == 0) return;
  // Layer k leaves when the flow has travelled k spacings.
  const double travelled = travel_ + flowSpeed * (end - begin);
  const double layersAfter = std::ceil(travelled / spacing_);
  double wanted = (layersAfter - layers_) * static_cast<double>(inLayer_);
  if (maxParticles.get()) wanted = std::min(wanted, static_cast<double>(*maxParticles.get() - emitted_));
  if (!(wanted <= std::numeric_limits<int>::max()))
    throw simulationError(fmt::format("{:.3g} particles would be emitted in one step", wanted),
                          "fewer than 2,147,483,648 particles", "use a smaller speed or a smaller world.dt");
  if (const auto count = static_cast<std::int64_t>(wanted); count > 0) {
    // Where the first layer is at the beginning of the step: this far behind the surface.
    const double firstOffset = layers_ * spacing_ - travel_ + flowSpeed * (begin - context.time);
    particles->positions.resize(count);
    particles->velocities.resize(count);
    particles->count = count;
    dispatch(context.device,
             [&](auto& device) { emitOn(device, count, firstOffset, static_cast<float>(flowSpeed)); });
    flow_ = {flowSpeed, firstOffset / flowSpeed, inLayer_};
    emitted_ += count;
  }
  layers_ = layersAfter;
  travel_ = travelled;
}

void Emitter::report(NodeReport& report) {
  report.statistics["particles_emitted"] = emitted_.get();
}

}  // namespace weir
