#include "nodes/samplers/sampler.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/graph/memory_estimate.h"
#include "framework/graph/setting_warning.h"

namespace weir {

float Sampler::requestedSpacing() const {
  const auto request = particles.requested();
  if (!request)
    throw sceneError("the sampler is not linked to a fluid, so its particle spacing is unknown",
                     "a link from '" + particles.path() + "' to the initial particles of a ParticleFluid");
  return request->spacing;
}

bool Sampler::relaxed() const {
  return isRelaxed(arrangement, *particles.requested());
}

void Sampler::fill(const SetupContext& context, const Lattice& lattice, const std::function<Region()>& region,
                   const std::function<bool(const Vec3f&)>& inside) {
  const auto* cpu = dynamic_cast<const CpuDevice*>(&context.device);
  const int threads = cpu ? cpu->threads() : 0;
  const std::uint64_t number = randomSeed(*this, context, seed);
  std::optional<RelaxedTile> tile;
  Displacement displacement;
  if (relaxed()) {
    tile.emplace(tileOfSource(*particles.requested(), number, context.device));
    displacement = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
      return tile->displacement(x, y, z);
    };
  }
  const std::vector<Vec3f> positions =
      sampleLattice(lattice, {jitter, number}, threads, inside, displacement);
  if (positions.empty())
    throw sceneError(fmt::format("no particle fits in at a spacing of {:.6g} m", lattice.spacing),
                     "a region that is several spacings thick");
  particles->assign(context.device, positions, velocity.get());
  particles->container.reset();
  if (relaxed()) putInside(context, region());
  sampled_ = particles->count;
  seen_ = false;
}

void Sampler::putInside(const SetupContext& context, const Region& region) {
  dispatch(context.device, [&](auto& device) { putInsideOn(device, region); });
  particles->container = region.outside;
  particles->contact = region.contact;
  particles->pressure = pressure;
}

Sampler::Region Sampler::regionOf(const SetupContext& context, Shape shape) const {
  shape.inverted = true;
  auto outside = std::make_shared<Boundary>();
  outside->pieces.push_back({.shape = shape});
  outside->onDevice = Array<BoundaryPiece>(context.device, outside->pieces);
  return {std::move(outside), 0.5f * requestedSpacing()};
}

void Sampler::warnOfRounding(const SetupContext& context, double volume, float spacing) const {
  constexpr double kNoticeable = 0.1;
  const double filled = static_cast<double>(particles->count) * spacing * spacing * spacing;
  if (std::abs(filled / volume - 1) > kNoticeable)
    context.log.warn(
        fmt::format("node '{}': its {} particles of {:.6g} m fill {:.3g} m³, {:+.0f} % of the "
                    "region's {:.3g} m³",
                    name(), particles->count, spacing, filled, 100 * (filled / volume - 1), volume));
}

void Sampler::warnOfThinness(const SetupContext& context, double thickness, float spacing) const {
  if (thickness >= kMinSpacings * spacing * (1 - kSettingRounding)) return;
  warnOfSetting(context.log, fmt::format("node '{}'", name()),
                fmt::format("the region is {:.3g} spacings thick, so the fluid in it is not resolved",
                            thickness / spacing),
                fmt::format("a spacing of at most {:.2g} m", thickness / kMinSpacings));
}

void Sampler::estimate(const SetupContext&, MemoryNeeds& needs) {
  particles->maxCount = maxParticleCount();
  needs.add(bytesOfArrays(particles->maxCount, particles->positions));
  if (relaxed()) needs.add(regionMemory());
  needs.remedy = [](double) { return std::string(); };  // the fluid's spacing decides
  // sampleLattice() holds all points twice for a moment.
  needs.host = 2 * sizeof(Vec3f) * particles->maxCount;
}

void Sampler::frame(const StepContext&) {
  seen_ = true;
}

void Sampler::step(const StepContext& context) {
  // Without a frame before, the fluid comes to rest in its first step.
  if ((context.index == 0 && !seen_) || particles->count == 0) return;
  particles->count = 0;
  particles->positions = Array<Vec3f>(context.device);
  particles->container.reset();
}

void Sampler::report(NodeReport& report) {
  report.statistics["particles_sampled"] = sampled_;
}

}  // namespace weir
