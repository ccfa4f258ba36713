#include "nodes/samplers/sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <utility>

#include "framework/communication/shared_by_ranks.h"
#include "framework/compute/dispatch.h"
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

Period Sampler::filledPeriod(const Aabb& box) const {
  constexpr float kRounding = 1e-3f;  // spacings
  Period filled = particles.requested()->period;
  const float near = kRounding * requestedSpacing();
  for (int axis = 0; axis < 3; ++axis) {
    const float low = filled.lo[axis], high = low + filled.size[axis];
    if (std::abs(box.lo[axis] - low) > near || std::abs(box.hi[axis] - high) > near) filled.size[axis] = 0;
  }
  return filled;
}

bool Sampler::relaxed() const {
  return isRelaxed(arrangement, *particles.requested());
}

namespace {

void fitInto(const Period& filled, const Lattice& lattice, std::vector<Vec3f>& positions) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!filled.along(axis)) continue;
    const double length = lattice.spacing * double(lattice.count[axis]),
                 low = lattice.first[axis] - 0.5 * lattice.spacing;
    for (Vec3f& p : positions)
      p[axis] = float(filled.lo[axis] + (double(p[axis]) - low) * double(filled.size[axis]) / length);
  }
  for (Vec3f& p : positions) p = filled.wrapped(p);
}

std::int64_t countOf(const LatticePoints& points) {
  std::int64_t count = 0;
  for (const auto& chunk : points) count += std::ssize(chunk);
  return count;
}

/// Which of all points those of this rank are.
std::vector<BatchPart::Run> runsOf(const std::vector<std::int64_t>& ownCounts, Communicator& ranks) {
  const auto bytes = std::as_bytes(std::span(ownCounts));
  std::vector<std::vector<std::int64_t>> counts;
  for (const Message& message : ranks.allGather(Message(bytes.begin(), bytes.end()))) {
    std::vector<std::int64_t>& of = counts.emplace_back(message.size() / sizeof(std::int64_t));
    if (!of.empty()) std::memcpy(of.data(), message.data(), message.size());
  }
  std::vector<BatchPart::Run> runs;
  std::int64_t first = 0, number = 0;
  for (std::size_t turn = 0; turn < counts.front().size(); ++turn)
    for (std::size_t rank = 0; rank < counts.size() && turn < counts[rank].size(); ++rank) {
      const std::int64_t count = counts[rank][turn];
      if (static_cast<int>(rank) == ranks.rank() && count > 0) {
        runs.push_back({first, number, count});
        first += count;
      }
      number += count;
    }
  return runs;
}

}  // namespace

bool Sampler::makesPart() const {
  return ranks_ != nullptr && std::ranges::all_of(particles.links(), [](const InputPort* reader) {
           return dynamic_cast<const SharedByRanks*>(&reader->node()) != nullptr;
         });
}

void Sampler::fill(const SetupContext& context, const std::vector<Lattice>& lattices, double volume,
                   const std::function<Region()>& region, const std::function<bool(const Vec3f&)>& inside,
                   const Period& filled) {
  const auto* cpu = dynamic_cast<const CpuDevice*>(&context.device);
  const int threads = cpu ? cpu->threads() : 0;
  const std::uint64_t number = randomSeed(*this, context, seed);
  Displacement displacement;
  if (relaxed()) {
    displacement = [tile = tileOfSource(*particles.requested(), number, context.device)](
                       std::int64_t x, std::int64_t y, std::int64_t z) {
      return tile->displacement(x, y, z);
    };
  }
  const LatticeShare share{makesPart() ? ranks_->rank() : 0, makers()};
  LatticePoints points;
  sampled_ = 0;
  double error = std::numeric_limits<double>::infinity();
  for (const Lattice& lattice : lattices) {
    if (error <= Lattice::kExact) break;
    LatticePoints found = sampleLattice(lattice, share, {jitter, number}, threads, inside, displacement);
    const std::int64_t count = countOfAll(found);
    const double fills = double(count) * lattice.spacing * lattice.spacing * lattice.spacing,
                 foundError = std::abs(fills / volume - 1);
    if (sampled_ > 0 && (count == 0 || foundError >= error)) continue;
    error = foundError;
    sampled_ = count;
    points = std::move(found);
  }
  if (sampled_ == 0)
    throw sceneError(fmt::format("no particle fits in at a spacing of {:.6g} m", lattices.front().spacing),
                     "a region that is several spacings thick");
  for (std::vector<Vec3f>& chunk : points) fitInto(filled, lattices.front(), chunk);
  put(context.device, std::move(points));
  if (relaxed()) putInside(context, region());
}

std::int64_t Sampler::countOfAll(const LatticePoints& points) const {
  const std::int64_t own = countOf(points);
  return makesPart() ? ranks_->sum(own) : own;
}

void Sampler::put(Device& device, LatticePoints points) {
  particles->count = countOf(points);
  particles->positions = Array<Vec3f>(device, particles->count);
  particles->velocities = Array<Vec3f>(device);
  particles->velocity = velocity;
  particles->container.reset();
  std::vector<std::int64_t> counts;
  Vec3f* to = particles->positions.data();
  for (std::vector<Vec3f>& chunk : points) {
    if (!chunk.empty()) device.upload(to, chunk.data(), chunk.size() * sizeof(Vec3f));
    to += chunk.size();
    counts.push_back(std::ssize(chunk));
    std::exchange(chunk, {});  // both would be twice the memory
  }
  part_ = {};
  if (makesPart()) part_ = {sampled_, runsOf(counts, *ranks_)};
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
  const double filled = static_cast<double>(sampled_) * spacing * spacing * spacing;
  if (std::abs(filled / volume - 1) > kNoticeable)
    context.log.warn(
        fmt::format("node '{}': its {} particles of {:.6g} m fill {:.3g} m³, {:+.0f} % of the "
                    "region's {:.3g} m³",
                    name(), sampled_, spacing, filled, 100 * (filled / volume - 1), volume));
}

void Sampler::warnOfStretch(const SetupContext& context, const Lattice& lattice, const Period& filled) const {
  constexpr double kNoticeable = 0.003;
  for (int axis = 0; axis < 3; ++axis) {
    if (!filled.along(axis)) continue;
    const double size = filled.size[axis], count = double(lattice.count[axis]),
                 stretch = size / (count * lattice.spacing) - 1;
    if (std::abs(stretch) > kNoticeable)
      warnOfSetting(context.log, fmt::format("node '{}'", name()),
                    fmt::format("{:.0f} spacings are stretched by {:+.2g} % to fill the period of {:.4g} m, "
                                "and the fluid is that far from rest density",
                                count, 100 * stretch, size),
                    fmt::format("a spacing of {:.6g} m, or a period of {:.6g} m", size / count,
                                count * lattice.spacing));
  }
}

void Sampler::warnOfThinness(const SetupContext& context, double thickness, float spacing) const {
  if (thickness >= kMinSpacings * spacing * (1 - kSettingRounding)) return;
  warnOfSetting(context.log, fmt::format("node '{}'", name()),
                fmt::format("the region is {:.3g} spacings thick, so the fluid in it is not resolved",
                            thickness / spacing),
                fmt::format("a spacing of at most {:.2g} m", thickness / kMinSpacings));
}

void Sampler::estimate(const SetupContext& context, MemoryNeeds& needs) {
  particles->maxCount = maxParticleCount();
  const int ranksHere = ranks_ != nullptr ? ranks_->sizeHere() : 1,
            onDevice = context.device.kind() == DeviceKind::kCpu ? ranksHere : 1;
  // Fluids that ranks share know what each has of them, and how long.
  if (!makesPart()) needs.add(onDevice * bytesOfArrays(particles->maxCount, particles->positions));
  if (relaxed()) needs.add(onDevice * regionMemory());
  needs.remedy = [](double) { return std::string(); };  // the fluid's spacing decides
  // Of two lattices, fill() holds the points of both for a moment.
  needs.host = ranksHere * 2 * sizeof(Vec3f) * std::ceil(particles->maxCount / makers());
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
