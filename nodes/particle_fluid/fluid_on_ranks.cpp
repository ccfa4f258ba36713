// What a fluid does where several ranks share its particles.
#include <fmt/format.h>

#include "framework/particles/divided_particles.h"
#include "nodes/particle_fluid/particle_fluid.h"

namespace weir {

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

void ParticleFluid::divideInitial() {
  State& state = *state_;
  divided_ = std::make_unique<DividedParticles>(*ranks_, state.particles, constants_.supportRadius);
  std::vector<Vec3f> all;
  for (std::size_t i = 0; i < initial.size(); ++i) {
    const std::vector<Vec3f> some = initial[i].positions.toHost(initial[i].count);
    all.insert(all.end(), some.begin(), some.end());
  }
  Aabb box;
  for (const Vec3f& p : all)
    if (isFinite(p)) box.extend(p);
  divided_->cut(box, all);
  fitSlab(box, std::ssize(all));
  if (ranks_->rank() == 0) makeState(gathered_, state.particles.device());
}

/// Of so many particles of all ranks.
void ParticleFluid::fitSlab(const Aabb& box, std::int64_t particles) {
  state_->neighbors.fitSlab({.own = divided_->ownLayers(), .all = divided_->allLayers()}, box, particles);
}

Aabb ParticleFluid::boxOnRanks(Device& onDevice) {
  State& state = *state_;
  dispatch(onDevice, [&](auto& device) { boundingBoxOn(device, state); });
  Aabb all;
  for (const Aabb& box : ranks_->allGather(state.extent.toHost().front().box))
    if (!box.empty()) all.extend(box.lo), all.extend(box.hi);
  return all;
}

void ParticleFluid::refreshOnRanks(const StepContext& context) {
  if (const std::int64_t all = divided_->countOfAll(); all > 0) {
    const Aabb box = boxOnRanks(context.device);
    divided_->cut(box);
    fitSlab(box, all);
    FluidStep now = fluidStep(context);
    now.findNeighbors();  // which removes what has left the domain
    findWalls(*state_, context);
  }
  if (gathered_) gathered_->particles.clear();
  divided_->gather(gathered_ ? &gathered_->particles : nullptr);
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

/// Counts of removed particles move to rank 0, which reports them.
void ParticleFluid::sumSinksOfRanks() {
  Device& device = state_->particles.device();
  for (int* const counter : sinkCounters()) {
    int own = 0;
    device.download(&own, counter, sizeof(own));
    const auto all = static_cast<int>(ranks_->sum(own));
    own = ranks_->rank() == 0 ? all : 0;
    device.upload(counter, &own, sizeof(own));
  }
}

void ParticleFluid::restoreOnRanks(const StateReader& from) {
  Device& device = state_->particles.device();
  const Aabb box = state_->neighbors.box();
  divided_->restore(from.in("particles"), box);
  fitSlab(box, divided_->countOfAll());
  Log silent;
  const StepContext now{device, silent, {}, 0, 0, 0};
  fluidStep(now).findNeighbors();
  if (!gathered_) return;
  gathered_->particles.clear();
  gathered_->particles.restore(from.in("particles"));
  if (gathered_->particles.bound() > 0) sortShown(device);
}

}  // namespace weir
