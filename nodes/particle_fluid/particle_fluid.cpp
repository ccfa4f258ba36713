#include "nodes/particle_fluid/particle_fluid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/auto_bulk_modulus.h"
#include "nodes/particle_fluid/fluid_warnings.h"
#include "nodes/particle_fluid/frame_on_ranks.h"
#include "nodes/particle_fluid/initial_batches.h"
#include "nodes/particle_fluid/modules/accelerated_solver.h"
#include "nodes/particle_fluid/modules/boundary_collision.h"
#include "nodes/particle_fluid/modules/neighbor_search.h"
#include "nodes/particle_fluid/modules/predict.h"
#include "nodes/particle_fluid/modules/solid_approach.h"
#include "nodes/particle_fluid/modules/solid_contact.h"
#include "nodes/particle_fluid/modules/wall_integrals.h"
#include "nodes/particle_fluid/modules/xsph.h"
#include "nodes/particle_fluid/own_wall_factor.h"
#include "nodes/particle_fluid/particle_limit.h"
#include "nodes/particle_fluid/rest_state.h"

namespace weir {

ParticleFluid::ParticleFluid() {
  fluid->offer(*this);
  pipeline_.add<Predict>("predict");
  pipeline_.add<SolidApproach>("approach");
  pipeline_.add<NeighborSearch>("neighbors");
  pipeline_.add<WallIntegrals>("walls");
  pipeline_.add<AcceleratedSolver>("solver");
  pipeline_.add<Xsph>("viscosity");
  pipeline_.add<BoundaryCollision>("boundary");
  pipeline_.add<SolidContact>("contact");
  pipeline_.markDefault();
}

ParticleFluid::~ParticleFluid() = default;

void ParticleFluid::validate() const {
  if (mu.get() && bulkModulus.get())
    throw sceneError("both bulk_modulus and mu are given",
                     "one of them: they say the same in different units");
  try {
    period();
  } catch (Error& e) {
    throw e.inParameter(periodic.name());
  }
  const Aabb box = domain();
  if (box.empty()) throw sceneError("domain_min is above domain_max", "a box that is not empty");
}

Aabb ParticleFluid::domain() const {
  constexpr float kFar = std::numeric_limits<float>::max();
  Aabb box{domainMin.get().value_or(Vec3f{-kFar, -kFar, -kFar}),
           domainMax.get().value_or(Vec3f{kFar, kFar, kFar})};
  // Nothing leaves through faces that are joined.
  for (int axis = 0; axis < 3; ++axis)
    if (period().along(axis)) box.lo[axis] = -kFar, box.hi[axis] = kFar;
  return box;
}

Period ParticleFluid::period() const {
  return periodOf(periodic, domainMin.get(), domainMax.get(), supportRatio * spacing);
}

/// Refuses what does not know of images.
void ParticleFluid::checkPeriodic() {
  const Period repeated = period();
  if (!repeated.any()) return;
  pipeline_.forEachEnabled("reset", [&](FluidModule& module) {
    if (dynamic_cast<InPeriodicDomain*>(&module) == nullptr && dynamic_cast<OnRanks*>(&module) == nullptr)
      throw sceneError(fmt::format("the module '{}' of type {} does not work in a periodic domain yet",
                                   module.name(), module.info().type),
                       "modules that do, such as SemiImplicitSolver, Xsph and ViscositySolver");
  });
  for (std::size_t i = 0; i < boundaries.size(); ++i)
    for (const BoundaryPiece& piece : boundaries[i].pieces)
      checkSolid(repeated, piece, supportRatio * spacing,
                 "the solid of '" + boundaries.links()[i]->node().name() + "'");
  for (std::size_t i = 0; i < initial.size(); ++i)
    checkBatch(repeated, initial[i], initial.links()[i]->node().name());
}

void ParticleFluid::configure(const SetupContext&) {
  const ParticleBatch::Request request{spacing, supportRatio, calibration == Calibration::kPacking, period()};
  fluid->period = period();
  initial.request(request);
  emitters.request(request);
  const WallKernel wall = wallKernel(supportRatio, calibration.get());
  boundaries.request({spacing, static_cast<float>(wall.radius) * spacing});
  sinks.request({spacing});
}

double ParticleFluid::memoryFor(Device& device, double owned) const {
  const double particles = owned * (1 + PeriodicImages::shareOf(period(), supportRatio * spacing));
  FluidRoom room{.particles = particles};
  for (const Particles::Request& request : fluid.requests()) room.solids += request.solids;
  room.wallShares = room.solids > 0;
  for (std::size_t i = 0; i < boundaries.size(); ++i) {
    room.wallShares |= boundaries[i].rubs || boundaries[i].reportsForces;
    room.boundaryForces |= boundaries[i].reportsForces;
  }
  NeighborList lists(device);
  lists.configure(supportRatio * spacing, neighborCapacity(supportRatio));
  double bytes = ParticleSet::memoryFor(particles) + lists.memoryFor(particles) +
                 WallField(device).memoryFor(room) +
                 (pressure ? 2 : 1) * ParticleSet::memoryOfAttribute(particles, AttributeType::kFloat, true);
  bytes += memoryOfBrought(particles);
  pipeline_.forEachEnabled("memory", [&](const FluidModule& module) { bytes += module.memory(room); });
  return bytes;
}

double ParticleFluid::memoryOfBrought(double particles) const {
  std::map<std::string, AttributeType> brought;  // several sources may bring the same
  for (const auto* sources : {&initial, &emitters})
    for (std::size_t i = 0; i < sources->size(); ++i)
      for (const BatchAttribute& attribute : (*sources)[i].attributes)
        brought.emplace(attribute.info.name, attribute.info.type);
  double bytes = 0;
  for (const auto& [name, type] : brought) bytes += ParticleSet::memoryOfAttribute(particles, type);
  return bytes;
}

void ParticleFluid::estimate(const SetupContext& context, MemoryNeeds& needs) {
  double atFirst = 0, born = 0;
  for (std::size_t i = 0; i < initial.size(); ++i) atFirst += initial[i].maxCount;
  for (std::size_t i = 0; i < emitters.size(); ++i) born += emitters[i].maxCount;
  maxParticles_ = atFirst + born;
  fluid->maxCount = maxParticles_;
  fluid->material.spacing = spacing;
  // What is proportional to their number is so to 1/spacing³.
  needs.remedy = [d = double(spacing)](double share) {
    const double fitting = d / std::cbrt(share), digit = std::pow(10, std::floor(std::log10(fitting)) - 2);
    return fmt::format("a spacing of at least {:.3g} m", std::ceil(fitting / digit) * digit);
  };
  const ShareOfRank share = ranks_ != nullptr ? shareOfRank(maxParticles_) : ShareOfRank{maxParticles_, 0};
  checkParticleCount({.all = maxParticles_,
                      .onRank = share.own + share.halo,
                      .ranks = ranks_ != nullptr ? ranks_->size() : 0,
                      .gathered = ranks_ != nullptr && isWatched(),
                      .spacing = spacing},
                     needs.remedy);
  needs.particles = maxParticles_;
  const auto memory = [&](double particles) {
    return ranks_ != nullptr ? memoryOnRanks(context.device, particles)
                             : memoryFor(context.device, particles);
  };
  needs.device = memory(maxParticles_);
  const bool mayLeave = !sinks.empty() || domainMin.get() || domainMax.get();
  needs.certain = mayLeave ? memory(atFirst) : needs.device;
}

void ParticleFluid::save(const StateWriter& to) const {
  if (divided_)
    divided_->save(to.in(kSavedParticles));
  else
    state_->particles.save(to.in(kSavedParticles));
  state_->neighbors.save(to.in("neighbors"));
  if (frame_) to.put("sums", frame_->sums);
  if (!emitters.empty()) state_->inflow.save(to.in("inflow"));
  to.put("events", state_->events);
  to.put("rest_steps", state_->restSteps);
  to.put("bulk_modulus", constants_.bulkModulus);
}

void ParticleFluid::restore(const StateReader& from) {
  State& state = *state_;
  state.restDt.reset();
  state.neighbors.restore(from.in("neighbors"));
  // The order is that of this grid already, so only the lists are new; what they count has been counted.
  if (divided_) {
    restoreOnRanks(from);
  } else {
    state.particles.restore(from.in(kSavedParticles));
    if (state.particles.bound() > 0) search();
  }
  state.neighbors.restore(from.in("neighbors"));
  if (divided_) fitSlab(state.neighbors.box(), divided_->countOfAll());
  state.inflow.restore(from.in("inflow"));
  from.get("rest_steps", state.restSteps);
  if (from.has("bulk_modulus") && !bulkModulus.get() && !mu.get())
    from.get("bulk_modulus", constants_.bulkModulus);
  state.resumed = true;  // solids, which are below, have not taken back their places yet
  restoreEvents(from);
}

/// Every rank has read what one has counted, and what all have counted together.
void ParticleFluid::restoreEvents(const StateReader& from) {
  const EventsOfAll ofOne = EventsOfAll::of(state_->neighbors.eventsOnHost());
  EventsOfAll all = ofOne;
  if (from.has("events")) from.get("events", all);
  if (divided_ && ranks_->rank() > 0) all = {};
  state_->moreEvents = {.truncated = all.truncated - ofOne.truncated,
                        .escaped = all.escaped - ofOne.escaped,
                        .nonFinite = all.nonFinite - ofOne.nonFinite,
                        .cutOffByOrder = all.cutOffByOrder - ofOne.cutOffByOrder};
  sumEvents();
}

namespace {

/// The first enabled module that has this role.
template <class Role, class Pipeline>
Role* firstEnabled(const Pipeline& pipeline) {
  for (const auto& module : pipeline.modules())
    if (auto* found = module->enabled() ? dynamic_cast<Role*>(module.get()) : nullptr) return found;
  return nullptr;
}

}  // namespace

void ParticleFluid::reset(const SetupContext& context) {
  const float volume = spacing * spacing * spacing;
  const float stiffened = mu.get() ? 1 : static_cast<float>(stiffening(supportRatio, calibration.get()));
  constexpr float kUsual = 1e6f;  // Pa
  const float stiffness = mu.get() ? *mu.get() / volume : stiffened * bulkModulus.get().value_or(kUsual);
  constants_ = makeFluidConstants(spacing, supportRatio, restDensity, stiffness, calibration);
  constants_.stiffened = stiffened;
  if (const auto* solver = firstEnabled<const OwnWallFactor>(pipeline_))
    constants_.wallFactor = solver->wallFactor(supportRatio) * constants_.calibration;
  State& state = makeState(context.device);
  gathered_.reset();
  divided_.reset();
  frame_.reset();
  checkPeriodic();
  const double images = PeriodicImages::shareOf(period(), constants_.supportRadius);
  if (maxParticles_ > 0)
    state.particles.expectAtMost(static_cast<std::int64_t>(maxParticles_ * (1 + images)));
  if (ranks_ != nullptr) {
    tellOfShares(context.log);
    divideInitial();
  }
  fluid->material = {
      .spacing = spacing, .density = {.value = restDensity}, .volume = {.value = constants_.particleVolume}};
  fluid->assign(shown());

  appendInitial();
  if (divided_) releaseInitial();
  chooseBulkModulus(context);
  const StepContext start{context.device, context.log, context.gravity, 0, context.dt, 0};
  FluidStep step = fluidStep(start);
  resetModules(step);
  refresh(start);
  warnOfSettings(context);
  state.restDt = context.dt;
  stepsTimed_ = 0;
}

void ParticleFluid::chooseBulkModulus(const SetupContext& context) {
  const PressureLaw* law = pressureLaw();
  if (bulkModulus.get() || mu.get() || law == nullptr || !law->toleratedCompression()) return;
  const InitialFluid there = fluidToCome(context);
  // By Bernoulli's law nothing that gravity and its first speed drive comes to more, where the flow is
  // steady.
  const double highest = hydrostaticPressure(there, context.gravity, restDensity) +
                         0.5 * restDensity * there.speed * there.speed;
  // Settled fluid bears a pressure p by λ − 1 = p/(γ·K') (fluid_constants.h): no more than at the usual
  // ratio.
  constexpr double kUsualRatio = 2;
  double response = 1;
  if (calibration == Calibration::kPacking)
    response = settledResponse(supportRatio) * constants_.stiffened / settledResponse(kUsualRatio);
  const double chosen = bulkModulusFor(highest / std::min(response, 1.0), *law->toleratedCompression());
  constants_.bulkModulus = constants_.stiffened * static_cast<float>(chosen);
  context.log.info(
      fmt::format("node '{}': a bulk_modulus of {:.0e} Pa, from a pressure of up to {:.3g} Pa and a "
                  "tolerance of {:.3g}",
                  name(), chosen, highest, *law->toleratedCompression()));
}

FluidExtent ParticleFluid::extentOf(Device& onDevice) {
  const ParticleSet& particles = state_->particles;
  dispatch(onDevice,
           [&](auto& device) { boundingBoxOn(device, particles.positions().read(), particles.count()); });
  return state_->extent.toHost().front();
}

InitialFluid ParticleFluid::presentFluid(Device& onDevice) {
  InitialFluid there;
  if (divided_) {
    there.box = boxOnRanks(onDevice);
    there.speed = ranks_->max(largestSpeed());
  } else if (state_->particles.bound() > 0) {
    there.box = extentOf(onDevice).box;
    there.speed = largestSpeed();
  }
  return there;
}

InitialFluid ParticleFluid::fluidToCome(const SetupContext& context) {
  InitialFluid there = presentFluid(context.device);
  const Vec3f g = context.gravity;
  const auto reach = [&](const Aabb& room) {
    const Vec3f lowest{(g.x > 0 ? room.hi : room.lo).x, (g.y > 0 ? room.hi : room.lo).y,
                       (g.z > 0 ? room.hi : room.lo).z};
    there.box.extend(emitters.empty() ? Aabb{lowest, lowest} : room);
  };
  for (const Boundary* boundary : state_->boundaries)
    for (const BoundaryPiece& piece : boundary->pieces)
      if (piece.bounded && piece.inverted()) reach(piece.bounds);
  if (domainMin.get() && domainMax.get()) reach(domain());
  return there;
}

ParticleFluid::State& ParticleFluid::makeState(Device& device) {
  State& state = state_.emplace(device);
  state.neighbors.configure(constants_.supportRadius, neighborCapacity(supportRatio));
  if (ranks_ != nullptr) state.neighbors.orderByIds();
  if (period().any()) state.images.emplace(state.particles, period(), constants_.supportRadius);
  state.density = state.particles.add<float>({.name = "density",
                                              .type = AttributeType::kFloat,
                                              .unit = "kg/m^3",
                                              .doc = "Density.",
                                              .derived = true});
  if (pressure)
    state.pressure = state.particles.add<float>({.name = "pressure",
                                                 .type = AttributeType::kFloat,
                                                 .unit = "Pa",
                                                 .doc = "Pressure, 0 where fluid is not compressed.",
                                                 .derived = true});
  for (std::size_t i = 0; i < boundaries.size(); ++i) state.boundaries.push_back(&boundaries[i]);
  state.walls.meet(state.boundaries, constants_, state.particles);
  std::vector<SinkPiece> sinkPieces;
  for (std::size_t i = 0; i < sinks.size(); ++i)
    sinkPieces.insert(sinkPieces.end(), sinks[i].pieces.begin(), sinks[i].pieces.end());
  state.sinks.assign(sinkPieces);
  return state;
}

void ParticleFluid::appendInitial() {
  for (const auto& [batch, part] : sharedBatches(initial, divided_ != nullptr)) {
    if (!divided_)
      state_->particles.append(*batch);
    else if (part != nullptr)
      appendPart(*divided_, state_->particles, *batch, *part);
    else
      divided_->append(*batch);
  }
}

std::int64_t ParticleFluid::accept(std::span<const std::unique_ptr<Solid>> solids) {
  for (const auto& solid : solids)
    checkSolid(period(), solid->view(0, 0), constants_.supportRadius, "a solid of the fluid");
  const std::int64_t removed = carve(solids);
  for (const auto& solid : solids) state_->walls.solids.push_back(solid.get());
  return ranks_ != nullptr ? ranks_->sum(removed) : removed;
}

std::int64_t ParticleFluid::carve(std::span<const std::unique_ptr<Solid>> solids) {
  ParticleSet& particles = state_->particles;
  const std::int64_t count = particles.refreshCount();
  if (count == 0) return 0;
  std::vector<SolidView> views;
  for (const auto& solid : solids) views.push_back(solid->view(0, 0));
  Device& device = particles.device();
  const Array<SolidView> onDevice(device, views);
  Array<int> inside(device, count + 1);  // the last is their number
  dispatch(device, [&](auto& backend) { markInsideOn(backend, onDevice, inside); });
  int number = 0;
  device.download(&number, inside.data() + count, sizeof number);
  if (number == 0) return 0;

  const std::vector<int> marks = inside.toHost(count);
  std::vector<int> kept;
  for (std::size_t i = 0; i < marks.size(); ++i)
    if (marks[i] == 0) kept.push_back(static_cast<int>(i));
  const std::int64_t removed = count - static_cast<std::int64_t>(kept.size());
  const int left = static_cast<int>(kept.size());
  device.upload(particles.counter(), &left, sizeof(int));
  const Array<int> order(device, kept);
  particles.permute(order.view());
  particles.refreshCount();
  return removed;
}

WallFinder* ParticleFluid::wallFinder() const {
  return firstEnabled<WallFinder>(pipeline_);
}

const PressureLaw* ParticleFluid::pressureLaw() const {
  return firstEnabled<const PressureLaw>(pipeline_);
}

const BulkEnergy& ParticleFluid::bulkEnergy() const {
  if (const PressureLaw* law = pressureLaw()) return law->bulkEnergy();
  throw sceneError("the fluid has no enabled module that knows its pressure",
                   "a module such as SemiImplicitSolver or AcceleratedSolver, or \"pressure\": false")
      .inParameter(pressure.name());
}

void ParticleFluid::resetModules(FluidStep& step) {
  pipeline_.forEach("reset", [&](FluidModule& module) { module.reset(step); });
}

void ParticleFluid::relaxInitialState(const StepContext& context) {
  Log silent;  // the modules have been reset before, and have said what they had to say
  // Regions act only after the solver, so in long steps gravity would press fluid through their sides.
  constexpr double kLongestFall = 0.05;  // spacings, g·dt²
  // Along a period nothing holds fluid.
  Vec3f gravity = context.gravity;
  for (int axis = 0; axis < 3; ++axis)
    if (period().along(axis)) gravity[axis] = 0;
  const double pull = length(gravity);
  const double longest = pull > 0 ? std::sqrt(kLongestFall * spacing / pull) : *state_->restDt;
  const StepContext start{context.device, silent, gravity, 0, std::min(*state_->restDt, longest), 0};
  state_->restDt.reset();
  FluidStep step = fluidStep(start);
  RestState rest(step, sharedBatches(initial, divided_ != nullptr));
  if (restSteps == 0 || !rest.wanted()) return;
  state_->walls.still = true;
  state_->restSteps = rest.reach(restSteps, [&] { runPipeline(step); });
  state_->walls.still = false;
  state_->walls.forgetImpulses();
  resetModules(step);
}

void ParticleFluid::warnOfSettings(const SetupContext& context) {
  if (initial.empty() && emitters.empty())
    context.log.warn(fmt::format(
        "node '{}': it stays empty, as nothing is linked to its inputs 'initial' and 'emitters'", name()));
  const InitialFluid there = presentFluid(context.device);
  const FluidOutlook outlook{.constants = constants_,
                             .dt = context.dt,
                             .pressure = hydrostaticPressure(there, context.gravity, restDensity),
                             .log = context.log,
                             .node = name()};
  warnOfFluid(outlook, there, context, pressureLaw() != nullptr);
  pipeline_.forEachEnabled("warn", [&](FluidModule& module) { module.warn(outlook); });
}

}  // namespace weir
