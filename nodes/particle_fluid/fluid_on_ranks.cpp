// What a fluid does where several ranks share its particles.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "framework/communication/ranks_report.h"
#include "framework/compute/dispatch.h"
#include "framework/particles/counts_removed.h"
#include "framework/particles/make_room.h"
#include "nodes/particle_fluid/frame_on_ranks.h"
#include "nodes/particle_fluid/initial_batches.h"
#include "nodes/particle_fluid/particle_fluid.h"

namespace weir {

namespace {

Aabb unionOfRanks(Communicator& ranks, const Aabb& own) {
  Aabb all;
  for (const Aabb& of : ranks.allGather(own)) all.extend(of);
  return all;
}

}  // namespace

void ParticleFluid::join(Communicator& ranks) {
  if (period().any())
    throw sceneError("a periodic domain cannot be on several ranks yet", "\"none\"", "run without --ranks")
        .inParameter(periodic.name());
  pipeline_.forEachEnabled("join", [&](FluidModule& module) {
    auto* onRanks = dynamic_cast<OnRanks*>(&module);
    if (onRanks == nullptr)
      throw sceneError(fmt::format("the module '{}' of type {} cannot run on several ranks yet",
                                   module.name(), module.info().type),
                       {},
                       "run without --ranks, or use modules that can, such as SemiImplicitSolver and Xsph");
    onRanks->join(ranks);
  });
  ranks_ = &ranks;
}

const Slabs* ParticleFluid::slabs() const {
  return divided_ ? &divided_->slabs() : nullptr;
}

/// All ranks have the same scene, and answer alike. What asks for something, as what brings solids does, does
/// with those that each rank has.
bool ParticleFluid::isWatched() const {
  return watched_ || fluid.links().size() > fluid.requests().size();
}

ParticleFluid::ShareOfRank ParticleFluid::shareOfRank(double all) const {
  const int ranks = ranks_->size();
  if (ranks == 1) return {all, 0};
  // Slabs are cut between layers across the longest axis, which have no more particles than those of a cube:
  // of a lattice, as many planes as find room.
  const double layer = std::min(all, (std::floor(double(supportRatio)) + 1) * std::pow(all, 2.0 / 3));
  return {std::min(all, std::ceil(all / ranks + layer)), std::ceil(layer * (ranks == 2 ? 1 : 2))};
}

double ParticleFluid::memoryOnRanks(Device& device, double all) const {
  const ShareOfRank share = shareOfRank(all);
  const double first = ParticleSet::memoryFor(share.own) + memoryOfBatches(initial, ranks_->size()),
               seen = share.own + share.halo;
  double later = memoryFor(device, seen) + DividedParticles::memoryFor(share.own, share.halo);
  if (restSteps > 0 && holdsParts(initial))
    later += ParticleSet::memoryOfAttribute(seen, AttributeType::kVec3);
  const double own = std::max(first, later);
  if (!isWatched()) return (device.kind() == DeviceKind::kCpu ? ranks_->sizeHere() : 1) * own;
  // All ranks but the first one send an attribute at a time.
  const double gathered = memoryOfGathered(all), sent = bytesOfArray(share.own, sizeof(Vec3f));
  if (device.kind() == DeviceKind::kCpu)
    return ranks_->sizeHere() * own + (ranks_->sizeHere() - 1) * sent + gathered;
  return own + (ranks_->rank() == 0 ? gathered : sent);
}

double ParticleFluid::memoryOfGathered(double all) const {
  std::map<std::string, AttributeType> attributes{{"position", AttributeType::kVec3},
                                                  {"velocity", AttributeType::kVec3},
                                                  {"id", AttributeType::kInt64},
                                                  {"density", AttributeType::kFloat}};
  if (pressure) attributes.emplace("pressure", AttributeType::kFloat);
  for (const auto* sources : {&initial, &emitters})
    for (std::size_t i = 0; i < sources->size(); ++i)
      for (const BatchAttribute& brought : (*sources)[i].attributes)
        attributes.emplace(brought.info.name, brought.info.type);
  double bytes = 0;
  for (const auto& [name, type] : attributes) bytes += ParticleSet::memoryOfAttribute(all, type, true);
  return bytes;
}

void ParticleFluid::divideInitial() {
  State& state = *state_;
  divided_ = std::make_unique<DividedParticles>(*ranks_, state.particles, constants_.supportRadius);
  const std::vector<SharedBatch> batches = sharedBatches(initial, true);
  Aabb own;
  std::int64_t all = 0;
  for (const SharedBatch& of : batches) {
    all += of.countOfAll();
    const std::int64_t count = of.batch->count;
    if (count == 0) continue;
    dispatch(state.particles.device(), [&](auto& device) {
      boundingBoxOn(device, {of.batch->positions.data(), count}, count);
    });
    own.extend(state.extent.toHost().front().box);
  }
  const Aabb box = unionOfRanks(divided_->ranks(), own);
  if (!box.empty()) {
    const InitialDivision division =
        initialDivision(divided_->ranks(), box, batches, constants_.supportRadius);
    divided_->follow(division.slabs);
    makeRoom(state.particles, division.own);
  }
  fitSlab(box, all);
  frame_ = std::make_unique<FrameOnRanks>();
  if (ranks_->rank() == 0 && isWatched()) gathered_.emplace(state.particles.device());
  if (maxParticles_ == 0) return;
  const ShareOfRank share = shareOfRank(maxParticles_);
  state.particles.expectAtMost(static_cast<std::int64_t>(share.own + share.halo));
  if (gathered_) gathered_->expectAtMost(static_cast<std::int64_t>(maxParticles_));
}

void ParticleFluid::releaseInitial() {
  releaseBatches(initial, state_->particles.device(), restSteps > 0);
}

/// Of so many particles of all ranks.
void ParticleFluid::fitSlab(const Aabb& box, std::int64_t particles) {
  state_->neighbors.fitSlab({.own = divided_->ownLayers(), .all = divided_->allLayers()}, box, particles);
}

Aabb ParticleFluid::boxOnRanks(Device& onDevice) {
  return unionOfRanks(divided_->ranks(), extentOf(onDevice).box);
}

void ParticleFluid::sortOnRanks(const StepContext& context) {
  const std::int64_t all = divided_->countOfAll();
  if (all == 0) return;
  const Aabb box = boxOnRanks(context.device);
  divided_->cut(box);
  fitSlab(box, all);
  FluidStep now = fluidStep(context);
  now.findNeighbors();  // which removes what has left the domain
}

void ParticleFluid::lookOnRanks() {
  State& state = *state_;
  frame_->particles = divided_->countOfAll();
  frame_->sums = sumsOfFluid(divided_->ranks(), state.particles, state.neighbors, constants_);
  if (isWatched()) gatherAll();
  Value& report = frame_->report;
  const auto ofRanks = [&](double own) { return meanAndMaxOfRanks(divided_->ranks(), own); };
  report["ranks"] = ranks_->size();
  report["particles"] = ofRanks(double(state.particles.bound()));
  report["halo"] = ofRanks(double(state.particles.haloCount()));
  report["gathered"] = isWatched() ? frame_->particles : 0;
  report["device_peak_bytes"] = ofRanks(double(state.particles.device().memoryUse().peak));
  report["step_ms"] = stepTimesOfRanks(*ranks_, divided_->times(), stepsTimed_);
}

void ParticleFluid::gatherAll() {
  if (gathered_) gathered_->clear();
  divided_->gather(gathered_ ? &*gathered_ : nullptr);
}

void ParticleFluid::tellOfShares(Log& log) const {
  if (maxParticles_ == 0) return;
  constexpr double kMillion = 1e6;
  const ShareOfRank share = shareOfRank(maxParticles_);
  log.info(
      fmt::format("node '{}': each of {} ranks has up to {:.4g} million particles and {:.3g} million copies "
                  "of others'; the first one gathers {}",
                  name(), ranks_->size(), share.own / kMillion, share.halo / kMillion,
                  isWatched() ? "all at frames" : "none"));
}

Value ParticleFluid::ranksReport() const {
  return frame_ ? frame_->report : Value::object();
}

/// Pieces of one sink share theirs.
std::vector<int*> ParticleFluid::sinkCounters() const {
  std::vector<int*> counters;
  for (std::size_t i = 0; i < sinks.size(); ++i)
    for (const SinkPiece& piece : sinks[i].pieces)
      if (counters.empty() || counters.back() != piece.removed) counters.push_back(piece.removed);
  return counters;
}

void ParticleFluid::forgetSinks() {
  for (int* const counter : sinkCounters()) state_->particles.device().fillBytes(counter, 0, sizeof(int));
}

/// What all have removed since the last frame.
void ParticleFluid::sumSinksOfRanks() {
  Device& device = state_->particles.device();
  for (std::size_t i = 0; i < sinks.size(); ++i) {
    auto* const sink = dynamic_cast<CountsRemoved*>(&sinks.links()[i]->node());
    if (sink == nullptr || sinks[i].pieces.empty()) continue;
    int own = 0, *const counter = sinks[i].pieces.front().removed;
    device.download(&own, counter, sizeof(own));
    device.fillBytes(counter, 0, sizeof(own));
    sink->addRemoved(ranks_->sum(own));
  }
}

void ParticleFluid::restoreOnRanks(const StateReader& from) {
  Device& device = state_->particles.device();
  const Aabb box = state_->neighbors.box();
  divided_->restore(from.in(kSavedParticles), box);
  fitSlab(box, divided_->countOfAll());
  Log silent;
  const StepContext now{device, silent, {}, 0, 0, 0};
  fluidStep(now).findNeighbors();
  frame_->particles = divided_->countOfAll();
  // A run without ranks has saved none; where this one makes no step, what it reports of density is 0.
  if (from.has("sums"))
    from.get("sums", frame_->sums);
  else
    frame_->sums = sumsOfFluid(divided_->ranks(), state_->particles, state_->neighbors, constants_);
  if (isWatched()) gatherAll();
}

}  // namespace weir
