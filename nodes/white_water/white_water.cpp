#include "nodes/white_water/white_water.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/compute/dispatch.h"
#include "framework/compute/profiler.h"
#include "framework/graph/memory_estimate.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/white_water/white_particles.h"

namespace weir {

namespace {

/// By which sums of steps may be off.
constexpr double kRounding = 1e-6;

void checkAscending(const Param<Vec2f>& limits, bool apart) {
  const Vec2f& at = limits.get();
  if (apart ? at.x < at.y : at.x <= at.y) return;
  throw sceneError(
      fmt::format("the first number, {:.4g}, is {} the second, {:.4g}", at.x,
                  at.x == at.y ? "the same as" : "above", at.y),
      apart ? "two numbers, the smaller one first" : "two numbers, the first no larger than the second")
      .inParameter(limits.name());
}

}  // namespace

void WhiteWater::validate() const {
  for (const auto* limits : {&airLimits, &crestLimits, &speedLimits}) checkAscending(*limits, true);
  for (const auto* range : {&lifetime, &radius}) checkAscending(*range, false);
}

/// What ranks own is enough.
void WhiteWater::configure(const SetupContext&) {
  fluid.request({});
}

void WhiteWater::estimate(const SetupContext& context, MemoryNeeds& needs) {
  const double n = static_cast<double>(maxParticles);
  particles->maxCount = n;
  particles->material.spacing = radius->x + radius->y;
  needs.particles = n;
  if (ranks_ != nullptr) {
    needs.device = memoryOnRanks(context.device);
  } else {
    needs.device = memoryOfOwn(n);
    needs.add(memoryOfSources(fluid->maxCount));
  }
  needs.remedy = [n](double share) { return fmt::format("max_particles of at most {:.2g}", share * n); };
}

double WhiteWater::memoryOfOwn(double n) const {
  return ParticleSet::memoryFor(n) + ParticleSet::memoryOfAttribute(n, AttributeType::kInt) +
         3 * ParticleSet::memoryOfAttribute(n, AttributeType::kFloat) +
         CellSort::kPerParticle * bytesOfArray(n, sizeof(int)) +
         bytesOfArray(n, 2 * sizeof(Vec3f) + sizeof(int) + 2 * sizeof(float));
}

double WhiteWater::memoryOfSources(double n) {
  return FluidGrid::memoryFor(n) + bytesOfArray(n, sizeof(Vec3f)) + bytesOfArray(n, sizeof(float)) +
         2 * bytesOfArray(n, sizeof(int));
}

void WhiteWater::reset(const SetupContext& context) {
  if (fluid->period.any())
    throw sceneError("white water does not pass the faces of a periodic domain yet",
                     "a fluid with \"periodic\": \"none\"");
  Device& device = context.device;
  seed_ = randomSeed(*this, context, seed);
  shared_.reset();
  set_.emplace(device);
  set_->expectAtMost(maxParticles);
  kind_ = set_->add<int>({"type", AttributeType::kInt, "", "0: spray, 1: foam, 2: bubble."});
  age_ = set_->add<float>({"age", AttributeType::kFloat, "s", "Time since its birth."});
  left_ =
      set_->add<float>({"lifetime", AttributeType::kFloat, "s", "Time that it has left as spray or foam."});
  radius_ = set_->add<float>({"radius", AttributeType::kFloat, "m", "Radius."});
  const double mean = 0.5 * (double(radius->x) + double(radius->y));
  particles->material = {
      .spacing = static_cast<float>(2 * mean),
      .density = {},
      .volume = {.value = static_cast<float>(4 / 3.0 * std::numbers::pi * mean * mean * mean)}};
  made_ = refused_ = steps_ = 0;
  waited_ = 0;
  removed_ = Array<int>(device, 1);
  removed_->fillZero();
  removedBefore_ = 0;
  warned_ = false;

  poses_ = Array<Pose>(device);
  walls_.emplace(device, dynamic_cast<const ParticleFluid*>(&fluid.links().front()->node()),
                 removed_->data());
  order_.emplace(device);
  born_ = {};
  sources_.emplace(device);
  grid_.emplace(device);
  if (ranks_ != nullptr) share(device);
  particles->assign(shown());
  grid_->fit(presentFluid());
  const MaterialField& volume = fluid->material.volume;
  if (!volume.byParticle() && !(volume.value > 0))
    throw sceneError("the particles of '" + fluid.links().front()->path() + "' have no volume",
                     "particles of a fluid, such as those of a ParticleFluid");
}

void WhiteWater::save(const StateWriter& to) const {
  if (shared_)
    shared_->particles.save(to.in(kSavedParticles));
  else
    set_->save(to.in(kSavedParticles));
}

void WhiteWater::restore(const StateReader& from) {
  if (shared_) {
    shared_->particles.follow(*sharedFluid().slabs());
    shared_->particles.restore(from.in(kSavedParticles));
  } else {
    set_->restore(from.in(kSavedParticles));
  }
  // As at the frame where it was saved, as the order of particles follows from it.
  grid_->fit(presentFluid());
  if (shared_ && ranks_->rank() > 0) removed_->fillZero();  // which rank 0 has counted
  if (shared_) lookOnRanks();
}

std::optional<StepContext> WhiteWater::ownStep(const StepContext& context) {
  const double passed = waited_ + context.dt, untilFrame = passed + context.untilFrame;
  // Even parts of the time until the next frame.
  const double wanted = maxDt > 0 ? untilFrame / std::ceil(untilFrame / maxDt * (1 - kRounding)) : 0;
  waited_ = passed;
  if (context.untilFrame > 0 && passed + context.dt <= wanted * (1 + kRounding)) return {};
  waited_ = 0;
  StepContext own = context;
  own.time = context.time + context.dt - passed;
  own.dt = passed;
  own.index = steps_;
  steps_ += 1;
  return own;
}

void WhiteWater::step(const StepContext& context) {
  const std::optional<StepContext> own = ownStep(context);
  if (!own) return;
  const ProfileScope scope(context.device.profiler(), name());
  dispatch(context.device, [&](auto& device) { stepOn(device, *own); });
}

void WhiteWater::frame(const StepContext&) {
  grid_->fit(presentFluid());
  if (shared_) lookOnRanks();
}

Particles WhiteWater::presentFluid() const {
  Particles present = *fluid;
  if (ranks_ != nullptr) present.assign(sharedFluid().owned());
  return present;
}

std::int64_t WhiteWater::particleCount() const {
  if (!set_) return 0;
  return shared_ ? shared_->tally.particles : set_->bound();
}

bool WhiteWater::followsRecordings() const {
  const auto* source = dynamic_cast<const ParticleFluid*>(&fluid.links().front()->node());
  if (source != nullptr &&
      std::ranges::any_of(source->solids(), [](const Solid* s) { return s->isMovedByForces(); }))
    throw sceneError("it meets bodies that the fluid moves, and a recording does not hold where they were",
                     "white water of such a fluid in the run itself")
        .inNode(name());
  return true;
}

WhiteParticles WhiteWater::elements() {
  return {.positions = set_->positions().write(),
          .velocities = set_->velocities().write(),
          .kinds = kind_.write(),
          .ages = age_.write(),
          .lifetimes = left_.write()};
}

void WhiteWater::limitReached(Log& log) {
  if (warned_) return;
  warned_ = true;
  log.warn(
      fmt::format("node '{}': there are {} particles, as many as max_particles allows, and fewer are made "
                  "from now on; better: a larger max_particles, or smaller trapped_air and wave_crests",
                  name(), maxParticles.get()));
}

void WhiteWater::makeRoomForBorn(std::int64_t count) {
  Device& device = set_->device();
  born_.count = count;
  if (born_.attributes.empty()) {
    born_.positions = Array<Vec3f>(device);
    born_.velocities = Array<Vec3f>(device);
    born_.attributes.push_back({kind_.info(), Array<int>(device)});
    born_.attributes.push_back({left_.info(), Array<float>(device)});
    born_.attributes.push_back({radius_.info(), Array<float>(device)});
  }
  born_.positions.resizeDiscarding(count);
  born_.velocities.resizeDiscarding(count);
  for (BatchAttribute& attribute : born_.attributes)
    std::visit([&](auto& values) { values.resizeDiscarding(count); }, attribute.values);
}

WhiteWater::Tally WhiteWater::tallyOwn() {
  const std::int64_t count = set_->refreshCount();
  if (count == 0) return {};
  Array<Vec3i> counted(set_->device(), 1);
  dispatch(set_->device(), [&](auto& device) { countKindsOn(device, counted.data()); });
  return {count, counted.toHost().front()};
}

void WhiteWater::report(NodeReport& report) {
  if (!set_) return;
  Value& v = report.statistics;
  const Tally tally = shared_ ? shared_->tally : tallyOwn();
  v["particles"] = tally.particles;
  v["spray"] = tally.kinds.x;
  v["foam"] = tally.kinds.y;
  v["bubbles"] = tally.kinds.z;
  v["particles_made"] = made_.get();
  v["particles_removed"] = removedBefore_ + removed_->toHost().front();
  v["particles_refused"] = refused_.get();
  report.events.push_back(
      {"white-water particles were not made, as there were max_particles", refused_.get()});
}

}  // namespace weir
