// What a fluid does in a step and at a frame, and what it reports then.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "framework/compute/dispatch.h"
#include "framework/particles/divided_particles.h"
#include "framework/particles/flight.h"
#include "framework/particles/inflow_role.h"
#include "nodes/particle_fluid/fluid_statistics.h"
#include "nodes/particle_fluid/frame_on_ranks.h"
#include "nodes/particle_fluid/particle_fluid.h"

namespace weir {

FluidStep ParticleFluid::fluidStep(const StepContext& time) {
  State& state = *state_;
  WallFinder* const finder = wallFinder();
  if (!state.walls.empty() && finder == nullptr)
    throw sceneError("the fluid meets solids, but no enabled module of it finds what it feels of them",
                     "a pipeline with such a module, as WallIntegrals is");
  return {time,
          time.device,
          constants_,
          state.particles,
          state.neighbors,
          state.boundaries,
          domain(),
          state.sinks.view(),
          state.walls,
          finder,
          divided_.get(),
          state.images ? &*state.images : nullptr};
}

void ParticleFluid::search() {
  State& state = *state_;
  state.neighbors.build(state.particles, domain(), state.sinks.view(),
                        state.images ? &*state.images : nullptr);
}

double ParticleFluid::longestStep(const StepContext& next, double cfl) {
  const bool empty = divided_ ? divided_->countOfAll() == 0 : state_->particles.bound() == 0;
  if (empty) return Node::longestStep(next, cfl);
  double fastest = largestSpeed();
  if (divided_) fastest = divided_->ranks().max(fastest);
  return timeToFly(cfl * spacing, fastest, length(next.gravity));
}

double ParticleFluid::largestSpeed() {
  dispatch(state_->particles.device(), [&](auto& device) { speedOn(device); });
  return std::sqrt(double(state_->speedSquared.toHost().front()));
}

void ParticleFluid::step(const StepContext& context) {
  if (state_->restDt) relaxInitialState(context);
  if (std::exchange(state_->resumed, false)) goOn(context);
  state_->inflow.carry(state_->particles, context, spacing);
  for (std::size_t i = 0; i < emitters.size(); ++i) give(i, context.time);
  // A rank without particles may get some.
  if (state_->particles.bound() == 0 && !divided_) return;
  // What the first frame took is no part of steps: it makes the first lists.
  if (divided_ && stepsTimed_ == 0) divided_->times().clear();
  FluidStep step = fluidStep(context);
  runPipeline(step);
  ++stepsTimed_;
}

void ParticleFluid::goOn(const StepContext& context) {
  if (divided_ && ranks_->rank() > 0) forgetSinks();  // which have taken back what rank 0 has counted
  // Ranks find them together.
  if (divided_ || state_->particles.bound() > 0) findWalls(context);
}

void ParticleFluid::runPipeline(FluidStep& step) {
  pipeline_.forEachEnabled("step", [&](FluidModule& module) {
    const ProfileScope scope(step.device.profiler(), module.name());
    module.step(step);
  });
}

/// Emitters do not know the solids, so what they put into one is left out here.
void ParticleFluid::give(std::size_t emitter, double time) {
  State& state = *state_;
  const ParticleBatch& born = emitters[emitter];
  if (born.count == 0) return;
  const auto* const flow = dynamic_cast<const FlowsIn*>(&emitters.links()[emitter]->node());
  if (flow != nullptr && flow->flow().speed > 0)
    state.inflow.add(born, static_cast<int>(emitter), flow->flow(), time, state.particles);
  BatchSelection selected;
  if (!state.walls.empty()) {
    state.walls.place(time, 0);
    dispatch(state.particles.device(), [&](auto& device) { selectOn(device, born); });
    selected = {state.born.order(), state.bornCount.data()};
  }
  if (divided_)
    divided_->append(born, selected);
  else
    state.particles.append(born, selected);
}

void ParticleFluid::frame(const StepContext& context) {
  if (state_->restDt) relaxInitialState(context);
  refresh(context);
}

void ParticleFluid::findWalls(const StepContext& context) {
  state_->walls.place(context.time, 0);
  FluidStep now = fluidStep(context);
  now.findWalls();
}

void ParticleFluid::refresh(const StepContext& context) {
  state_->gravity = context.gravity;
  if (divided_)
    sortOnRanks(context);
  else if (state_->particles.refreshCount() > 0)
    sortAlone(context.device);
  refreshLooks(context);
  if (divided_) lookOnRanks();
  sumEvents();
  if (divided_) sumSinksOfRanks();
  checkEvents();
}

void ParticleFluid::sortAlone(Device& onDevice) {
  State& state = *state_;
  const FluidExtent extent = extentOf(onDevice);
  state.neighbors.fitGrid(extent.box, state.particles.bound(),
                          (1 / float(state.particles.bound())) * extent.sum);
  search();
  state.particles.refreshCount();
}

/// Brings up to date what only somebody who looks wants to know.
void ParticleFluid::refreshLooks(const StepContext& context) {
  State& state = *state_;
  // Ranks find walls together.
  if (divided_ ? divided_->countOfAll() == 0 : state.particles.bound() == 0) return;
  state.walls.pairs.waitForNumber();
  findWalls(context);
  dispatch(context.device, [&](auto& device) {
    densityOn(device);
    if (pressure) pressureOn(device);
  });
}

void ParticleFluid::sumEvents() {
  const EventsOfAll own = EventsOfAll::of(state_->neighbors.eventsOnHost());
  const EventsOfAll& more = state_->moreEvents;
  std::array<std::int64_t, 4> sums{own.truncated + more.truncated, own.escaped + more.escaped,
                                   own.nonFinite + more.nonFinite, own.cutOffByOrder + more.cutOffByOrder};
  if (divided_) ranks_->sum(sums);
  state_->events = {sums[0], sums[1], sums[2], sums[3]};
}

void ParticleFluid::checkEvents() {
  State& state = *state_;
  // A few lost numbers are tolerated and reported; more means that the simulation has blown up.
  constexpr std::int64_t kMaxNonFinite = 10;
  constexpr double kMaxNonFiniteShare = 1e-3;
  const double max = std::max(double(kMaxNonFinite), kMaxNonFiniteShare * double(particleCount()));
  const bool speaks = !divided_ || ranks_->rank() == 0;
  if (speaks && double(state.events.nonFinite) > max)
    throw simulationError(
        fmt::format(
            "the simulation diverged: {} particles have positions or velocities that are NaN or infinite",
            state.events.nonFinite),
        {}, "use a smaller world.dt, a smaller bulk_modulus, or more solver iterations");
  const std::int64_t lost = state.walls.empty() ? 0 : state.walls.pairs.lostOnHost();
  if (lost > 0)
    throw simulationError(
        fmt::format(
            "particles came near more solids in one frame than there was room for: {} pairs of a particle "
            "and a solid were lost",
            lost),
        {}, "use a larger world.frame_rate, as room is made at every frame, or run on the CPU");
  if ((divided_ || state.particles.device().deterministic()) && state.events.cutOffByOrder > 0)
    throw simulationError(
        fmt::format(
            "{} times neighbour lists were cut off in an order that may differ from run to run, which "
            "--deterministic and ranks forbid",
            kListGroup * state.events.cutOffByOrder),
        {}, "use a smaller support_ratio or spread the fluid less, or run without these");
}

std::int64_t ParticleFluid::particleCount() const {
  if (!state_) return 0;
  return frame_ ? frame_->particles : state_->particles.bound();
}

void ParticleFluid::report(NodeReport& report) {
  if (!state_) return;
  State& state = *state_;
  if (!divided_) state.particles.refreshCount();
  const FluidSums sums = frame_ ? frame_->sums : sumsOfFluid(state.particles, state.neighbors, constants_);
  writeFluidStatistics(particleCount(), sums, constants_, state.gravity, report.statistics);
  report.statistics["rest_steps"] = state.restSteps;
  report.statistics["bulk_modulus"] = double(constants_.bulkModulus) / constants_.stiffened;
  const EventsOfAll& events = state.events;
  report.statistics["neighbors_truncated"] = events.truncated;
  report.statistics["particles_escaped"] = events.escaped;
  report.statistics["particles_not_finite"] = events.nonFinite;
  report.events.push_back(
      {"neighbour lists were cut off (more neighbours than there is room for)", events.truncated});
  report.events.push_back({"particles left the domain and were removed", events.escaped});
  report.events.push_back(
      {"particles with positions that are NaN or infinite were removed", events.nonFinite});
  pipeline_.forEachEnabled("report", [&](FluidModule& module) { module.report(report); });
}

}  // namespace weir
