#include "nodes/white_water/white_water.h"

#include "framework/compute/parallel_uneven.h"
#include "nodes/white_water/dragged_motion.h"
#include "nodes/white_water/draws.h"
#include "nodes/white_water/fluid_walls.h"
#include "nodes/white_water/sources.h"
#include "nodes/white_water/white_particles.h"

namespace weir {

namespace {

/// Where a particle goes without walls and, but for its drag, without fluid.
struct Course {
  Vec3f gravity;
  float airDrag, dt;  // 1/s, s

  WEIR_HD static bool flies(int kind) { return kind == static_cast<int>(WhiteKind::kSpray); }
  WEIR_HD Motion flown(const Motion& start) const { return dragged(start, gravity, airDrag, dt); }
  WEIR_HD Vec3f end(const Motion& start, int kind) const {
    return flies(kind) ? flown(start).position : start.position + dt * start.velocity;
  }
};

struct FindAhead {
  Course course;
  ArrayView<const Vec3f> positions, velocities;
  ArrayView<const int> kinds;
  ArrayView<Vec3f> ahead;
  WEIR_HD void operator()(std::int64_t i) const {
    ahead[i] = course.end({positions[i], velocities[i]}, kinds[i]);
  }
};

/// Moves particle i by a step, and says what it is.
struct Advance {
  FluidGridView fluid;
  FluidWalls walls;
  Course course;
  Vec3f rise;       // m/s
  Vec3f lift;       // m/s, of foam half a spacing below the surface
  float waterDrag;  // 1/s
  float filmAging;  // times as fast as on deep water
  float dt;
  std::int64_t step;
  ArrayView<const std::int64_t> ids;
  WhiteParticles all;

  WEIR_HD void operator()(std::int64_t i) const {
    const Motion start{all.positions[i], all.velocities[i]};
    // Where it will be, as the fluid is there already.
    const Vec3f ahead = course.end(start, all.kinds[i]);
    if (!isFinite(ahead)) {
      all.lifetimes[i] = 0;
      return;
    }
    const FluidSample here = fluidAt(fluid, ahead);
    const float open = 1 - walls.hidden(ahead, fluid.radius);
    const float filled = here.filled > 0 ? here.filled / open : 0.0f;
    const WhiteKind kind = kindOf(filled);
    Motion moved = kind == WhiteKind::kSpray ? course.flown(start)
                   : kind == WhiteKind::kFoam
                       ? drifted(start, here.velocity + depthOf(filled) * lift, all.kinds[i])
                       : risen(start, here.velocity);
    walls.stop(start.position, false, moved);
    all.positions[i] = moved.position;
    all.velocities[i] = moved.velocity;
    all.kinds[i] = static_cast<int>(kind);
    all.ages[i] += dt;
    if (kind != WhiteKind::kBubble)
      all.lifetimes[i] -= kind == WhiteKind::kFoam ? dt * agingOfFoam(i, ahead, here) : dt;
    if (!isFinite(moved.position) || walls.removes(moved.position)) all.lifetimes[i] = 0;
  }

  /// How fast: by what fills the fluid a radius further in, where walls count as none. That is looked at in
  /// every fourth step, and counts for all four: another sum in each would make a third of the cost.
  WEIR_HD float agingOfFoam(std::int64_t i, const Vec3f& p, const FluidSample& here) const {
    constexpr int kEvery = 4;
    const float way = length(here.middle);
    if (filmAging == 1 || (ids[i] + step) % kEvery != 0 || !(way > 0)) return 1;
    const float below = fluidAt(fluid, p + (fluid.radius / way) * here.middle).filled;
    const float thin = (kFilledBelow - below) / (kFilledBelow - kFilledAbove);
    return 1 + kEvery * (filmAging - 1) * (thin > 0 ? (thin < 1 ? thin : 1.0f) : 0.0f);
  }

  /// By Heun's method, where it had the fluid's velocity.
  WEIR_HD Motion drifted(const Motion& start, const Vec3f& flow, int before) const {
    const bool was = before == static_cast<int>(WhiteKind::kFoam);
    return {start.position + dt * (was ? 0.5f * (start.velocity + flow) : flow), flow};
  }

  WEIR_HD Motion risen(const Motion& start, const Vec3f& flow) const {
    if (waterDrag == 0) return {start.position + dt * flow, flow};
    return dragged(start, waterDrag * (flow + rise), waterDrag, dt);
  }
};

struct CellOfAlive {
  CellGrid grid;
  ArrayView<const Vec3f> positions;
  ArrayView<const float> lifetimes;
  WEIR_HD int operator()(std::int64_t i) const {
    return lifetimes[i] > 0 ? grid.index(grid.cellOf(positions[i])) : -1;
  }
};

/// Particle b of the batch, the one after `first` of all ranks. Where there is no room for all that are
/// wanted, they are evenly thinned.
struct Spawn {
  std::int64_t first, born, wanted;
  std::int64_t wantedBefore;  // on other ranks
  std::uint64_t seed;
  std::int64_t step;
  float dt, spread;  // s, m
  Vec2f lifetimes, radii;
  FluidWalls walls;
  ArrayView<const int> before;
  ArrayView<const float> filled;
  ArrayView<const Vec3f> positions, velocities;
  ArrayView<const std::int64_t> ids;
  ArrayView<Vec3f> bornPositions, bornVelocities;
  ArrayView<int> kinds;
  ArrayView<float> bornLifetimes, bornRadii;

  WEIR_HD void operator()(std::int64_t b) const {
    const std::int64_t k = first + b, ofAll = born == wanted ? k : k * wanted / born;
    const auto number = static_cast<int>(ofAll - wantedBefore);
    const std::int64_t i = parentOf(number);
    Draws draws(seed, ids[i], step, number - before[i]);
    const Vec3f parent = positions[i], v = velocities[i], along = normalized(v);
    const Vec3f across = anyAcross(along), third = cross(along, across);
    constexpr float kTwoPi = 6.2831853f;
    const float distance = spread * sqrtf(draws.next()), angle = kTwoPi * draws.next();
    const Vec3f aside = distance * (cosf(angle) * across + sinf(angle) * third);
    Motion at{parent + aside - (draws.next() * dt) * v, v};
    walls.stop(parent, true, at);
    bornPositions[b] = at.position;
    bornVelocities[b] = at.velocity;
    kinds[b] = static_cast<int>(kindOf(filled[i]));
    bornLifetimes[b] = draws.within(lifetimes);
    bornRadii[b] = draws.within(radii);
  }

  /// The last one before which there are no more than `number`.
  WEIR_HD std::int64_t parentOf(int number) const {
    std::int64_t low = 0, high = before.size - 1;
    while (high - low > 1) {
      const std::int64_t middle = (low + high) / 2;
      (before[middle] <= number ? low : high) = middle;
    }
    return low;
  }

  WEIR_HD static Vec3f anyAcross(const Vec3f& v) {
    return normalized(cross(v, fabsf(v.x) < 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0}));
  }
};

struct OneOfKind {
  ArrayView<const int> kinds;
  WEIR_HD Vec3i operator()(std::int64_t i) const {
    return {kinds[i] == 0 ? 1 : 0, kinds[i] == 1 ? 1 : 0, kinds[i] == 2 ? 1 : 0};
  }
};

struct AddCounts {
  WEIR_HD Vec3i operator()(const Vec3i& a, const Vec3i& b) const { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
};

}  // namespace

template <class Backend>
void WhiteWater::stepOn(Backend& device, const StepContext& context) {
  if (shared_) migrateOn(device, context);
  const Particles of = presentFluid();
  grid_->sort(device, of, shared_ ? shared_->fluid.points() : ArrayView<const FluidPoint>{});
  walls_->place(context.time, context.dt, *poses_);
  if (set_->bound() > 0) {
    advanceOn(device, context);
    sortAliveOn(device);
  }
  // Ranks count together.
  if (of.set().bound() == 0 && !shared_) return;
  countBornOn(device, of, context);
  int wanted = 0;
  device.download(&wanted, sources_->before.data() + of.set().bound(), sizeof(int));
  if (set_->bound() > 0) set_->refreshCount();
  const Births births = birthsOfAll(wanted);
  if (births.wanted > 0) bearOn(device, of, context, births);
}

template <class Backend>
void WhiteWater::migrateOn(Backend& device, const StepContext& context) {
  const Slabs& slabs = *sharedFluid().slabs();
  sharedFluid().owned().refreshCount();
  set_->refreshCount();
  ++shared_->stepsTimed;
  Array<Vec3f>& ahead = shared_->ahead;
  ahead.resizeDiscarding(set_->bound());
  parallelFor(device, "ahead", set_->count(),
              FindAhead{{context.gravity, airDrag, static_cast<float>(context.dt)},
                        std::as_const(*set_).positions().read(),
                        std::as_const(*set_).velocities().read(),
                        std::as_const(kind_).read(),
                        ahead.view()});
  shared_->particles.follow(slabs);
  shared_->particles.migrate(std::as_const(ahead).view());
  const Particles of = presentFluid();
  const RankTimes::Scope scope(shared_->particles.times(), RankWork::kHalo);
  // As far as the neighbours of a particle's neighbours.
  shared_->fluid.fetch(of, grid_->boxOf(of), slabs, 2 * kNearRadius * of.material.spacing);
}

template <class Backend>
void WhiteWater::advanceOn(Backend& device, const StepContext& context) {
  const float pull = length(context.gravity), dt = static_cast<float>(context.dt);
  const float half = 0.5f * fluid->material.spacing, way = riseSpeed * dt;
  // Displaced water makes bubbles start with twice gravity, so this is the rate that ends at rise_speed.
  const float rate = riseSpeed > 0 ? 2 * pull / riseSpeed : 0;
  const Vec3f rise = pull > 0 ? (-riseSpeed / pull) * context.gravity : Vec3f{};
  parallelForUneven(device, "white water", set_->count(),
                    Advance{.fluid = grid_->view(),
                            .walls = walls_->view(),
                            .course = {context.gravity, airDrag, dt},
                            .rise = rise,
                            .lift = (way > half ? half / way : 1.0f) * rise,
                            .waterDrag = rate,
                            .filmAging = 1 / filmLifetime,
                            .dt = dt,
                            .step = context.index,
                            .ids = std::as_const(*set_).ids().read(),
                            .all = elements()});
}

template <class Backend>
void WhiteWater::sortAliveOn(Backend& device) {
  const CellGrid grid = grid_->view().grid;
  order_->sort(device, set_->count(), grid.cellCount(),
               CellOfAlive{grid, std::as_const(*set_).positions().read(), std::as_const(left_).read()},
               set_->counter());
  set_->permute(order_->order());
}

template <class Backend>
void WhiteWater::findNormalsOn(Backend& device) {
  Sources& found = *sources_;
  found.fast.resizeDiscarding(grid_->cells());
  found.normals.resizeDiscarding(grid_->count().bound);
  parallelFor(device, "fast cells", grid_->cells(),
              MarkFast{grid_->view(), speedLimits->x * speedLimits->x, found.fast.view()});
  parallelForUneven(
      device, "normals", grid_->count(),
      FindNormal{grid_->view(), walls_->view(), std::as_const(found.fast).view(), found.normals.view()});
}

template <class Backend>
void WhiteWater::countBornOn(Backend& device, const Particles& of, const StepContext& context) {
  Sources& found = *sources_;
  const std::int64_t own = of.set().bound(), all = shared_ ? shared_->particles.ranks().sum(own) : own;
  for (Array<int>* array : {&found.born, &found.before}) array->resizeDiscarding(own + 1);
  found.filled.resizeDiscarding(own);
  found.born.fillZero();
  if (waveCrests > 0) findNormalsOn(device);
  const auto limits = [](const Vec2f& at) { return Ramp{at.x, at.y}; };
  parallelForUneven(
      device, "sources", grid_->count(),
      CountBorn{.fluid = grid_->view(),
                .order = grid_->order(),
                .normals = waveCrests > 0 ? std::as_const(found.normals).view() : ArrayView<const Vec3f>{},
                .ids = std::as_const(of.set()).ids().read(),
                .energy = limits({speedLimits->x * speedLimits->x, speedLimits->y * speedLimits->y}),
                .air = limits(airLimits),
                .crest = limits(crestLimits),
                .airRate = trappedAir,
                .crestRate = waveCrests,
                .dt = static_cast<float>(context.dt),
                .max = static_cast<float>(std::numeric_limits<int>::max() / (all + 1)),
                .seed = seed_,
                .step = context.index,
                .filled = found.filled.view(),
                .born = found.born.view()});
  exclusiveScan(device, std::as_const(found.born).view(), found.before.view(), own + 1);
}

template <class Backend>
void WhiteWater::bearOn(Backend& device, const Particles& of, const StepContext& context,
                        const Births& births) {
  made_ += births.made;
  refused_ += births.wanted - births.made;
  if (births.made < births.wanted) limitReached(context.log);
  const std::int64_t first = births.firstMade(births.before),
                     born = births.firstMade(births.before + births.own) - first, id = set_->nextId();
  if (born > 0) {
    makeRoomForBorn(born);
    const ParticleSet& parents = of.set();
    parallelFor(device, "bear", born,
                Spawn{.first = first,
                      .born = births.made,
                      .wanted = births.wanted,
                      .wantedBefore = births.before,
                      .seed = seed_,
                      .step = context.index,
                      .dt = static_cast<float>(context.dt),
                      .spread = 0.5f * fluid->material.spacing,
                      .lifetimes = lifetime,
                      .radii = radius,
                      .walls = walls_->view(),
                      .before = std::as_const(sources_->before).view(),
                      .filled = std::as_const(sources_->filled).view(),
                      .positions = parents.positions().read(),
                      .velocities = parents.velocities().read(),
                      .ids = parents.ids().read(),
                      .bornPositions = born_.positions.view(),
                      .bornVelocities = born_.velocities.view(),
                      .kinds = std::get<Array<int>>(born_.attributes[0].values).view(),
                      .bornLifetimes = std::get<Array<float>>(born_.attributes[1].values).view(),
                      .bornRadii = std::get<Array<float>>(born_.attributes[2].values).view()});
    set_->continueIdsFrom(id + first);
    set_->append(born_);
  }
  set_->continueIdsFrom(id + births.made);
}

template <class Backend>
void WhiteWater::countKindsOn(Backend& device, Vec3i* counts) {
  reduce(device, "count kinds", set_->count(), Vec3i{0, 0, 0}, OneOfKind{std::as_const(kind_).read()},
         AddCounts{}, counts);
}

template void WhiteWater::stepOn(ThisBackend&, const StepContext&);
template void WhiteWater::countKindsOn(ThisBackend&, Vec3i*);

}  // namespace weir
