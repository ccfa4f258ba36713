#include "nodes/samplers/sampler.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/base/random.h"
#include "framework/graph/setting_warning.h"

namespace weir {

float Sampler::requestedSpacing() const {
  const auto request = particles.requested();
  if (!request)
    throw sceneError("the sampler is not linked to a fluid, so its particle spacing is unknown",
                     "a link from '" + particles.path() + "' to the initial particles of a ParticleFluid");
  return request->spacing;
}

void Sampler::fill(const SetupContext& context, const Lattice& lattice,
                   const std::function<bool(const Vec3f&)>& inside) {
  const auto* cpu = dynamic_cast<const CpuDevice*>(&context.device);
  const Jitter moved{jitter, static_cast<std::uint64_t>(context.seed) ^ hashOf(name())};
  const std::vector<Vec3f> positions = sampleLattice(lattice, moved, cpu ? cpu->threads() : 0, inside);
  if (positions.empty())
    throw sceneError(fmt::format("no particle fits in at a spacing of {:.6g} m", lattice.spacing),
                     "a region that is several spacings thick");
  particles->assign(context.device, positions, std::vector<Vec3f>(positions.size(), velocity.get()));
  sampled_ = particles->count;
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
  if (thickness >= kLeastSpacings * spacing * (1 - kSettingRounding)) return;
  warnOfSetting(context.log, fmt::format("node '{}'", name()),
                fmt::format("the region is {:.3g} spacings thick, so the fluid in it is not resolved",
                            thickness / spacing),
                fmt::format("a spacing of at most {:.2g} m", thickness / kLeastSpacings));
}

void Sampler::step(const StepContext& context) {
  if (context.index == 0 || particles->count == 0) return;
  particles->count = 0;
  particles->positions = Array<Vec3f>(context.device);
  particles->velocities = Array<Vec3f>(context.device);
}

void Sampler::report(NodeReport& report) {
  report.statistics["particles_sampled"] = sampled_;
}

}  // namespace weir
