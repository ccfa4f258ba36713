#include "nodes/particle_fluid/modules/semi_implicit_solver.h"

#include <limits>

#include "framework/neighbors/motion_code.h"
#include "nodes/particle_fluid/containment.h"
#include "nodes/particle_fluid/density.h"
#include "nodes/particle_fluid/modules/first_derivative.h"
#include "nodes/particle_fluid/modules/semi_implicit_judge.h"
#include "nodes/particle_fluid/modules/semi_implicit_passes.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

namespace {

/// Adds to each particle's state Ḃ(λ), the derivative of the bulk energy.
struct EnergyDerivative {
  static constexpr Standing kLeaves = Standing::kLists, kReadsAhead = Standing::kLists;
  NeighborView neighbors;
  SpikyKernel kernel;
  float particleVolume;
  BulkEnergy energy;
  bool tension;
  WallFieldView walls;
  ArrayView<const Vec3f> displacement;
  ArrayView<const Vec4f> state;
  ArrayView<Vec4f> weighted;
  ArrayView<float> excess;  // empty where nobody asks for it

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    auto lambda = relativeDensity(i, neighbors, kernel, particleVolume, state);
    if (!walls.empty()) lambda += walls.phi(i, read(displacement, i));
    const auto e = detail::excessOf(lambda, tension);
    const auto s = read(state, i);
    write(weighted, i, {s.x, s.y, s.z, energy.derivative(e)});
    if (excess.size > 0) write(excess, i, e);
  }
};

/// What pushes a particle, and how far it may go: the bracket of the class comment is `push` - displacement.
template <class T>
struct Push {
  Vec3<T> push;
  T divisor;
  T wall;  // the part wall·∇Φ of the push comes from walls
};

struct PushOf {
  NeighborView neighbors;
  SpikyKernel kernel;
  float stiffness;      // (c·dt)²·V0
  float shortest;       // m; closer pairs are treated as this far apart, along their direction
  float own, others;    // weights of Ḃ_i and Ḃ_j
  float negativePart;   // |Ḃ⁻|
  float wallStiffness;  // (c·dt)²
  WallFieldView walls;
  ArrayView<const Vec4f> weighted;

  // Inline, so that what is the same for all particles is prepared once for all.
  template <class Index, class Weight = detail::AsStored>
  [[gnu::always_inline]] WEIR_HD Push<NumberAt<Index>> operator()(Index i, const Weight& weight = {}) const {
    const auto list = neighborsAhead(i, neighbors);
    awaitBefore(i);
    const auto s = read(weighted, i);
    const auto ownWeight = own * weight(s.w);
    const auto self = asInt(i);
    const auto pairPush = [&]<class T>(const auto& j, const Vec4<T>& t) {
      Vec3<T> d{t.x - s.x, t.y - s.y, t.z - s.z};
      T r = fastSqrt(dot(d, d));
      // Particles in one place would stay there for ever; the sign makes the two directions opposite.
      if (anyLane(r < T(shortest))) {
        d.x = select(r == T(0), select(j > self, T(shortest), T(-shortest)), d.x);
        r = select(r < T(shortest), T(shortest), r);
      }
      const T a = fastDivide(stiffness * kernel.slope(r), r);
      const T b = (ownWeight + others * weight(t.w)) * a;
      return Vec4<T>{b * d.x, b * d.y, b * d.z, a};
    };
    const auto sum = sumOverNeighbors<Vec4f>(list, pairPush, weighted);
    Push<NumberAt<Index>> total{-xyz(sum), 1 + (own + others) * negativePart * sum.w, 0};
    if (!walls.empty()) addWalls(i, weight(s.w), total);
    return total;
  }

  /// The gradient of what walls add to the energy: with λ it depends on the particle's own place alone.
  template <class Index, class T>
  WEIR_HD void addWalls(Index i, const T& derivative, Push<T>& total) const {
    const T d = positivePart(read(walls.d, i));
    if (!any(d > T(0))) return;
    total.wall = zeroUnless(d > T(0), -derivative * wallStiffness);
    total.push += total.wall * walls.gradient(i);
    total.divisor += negativePart * wallStiffness * d;
  }

  /// Moves the share of the walls in the displacement like the displacement itself.
  template <class Index, class T>
  WEIR_HD void followWalls(Index i, const Push<T>& at, float stepLength = 1) const {
    if (walls.empty()) return;
    const T share = read(walls.share, i);
    write(walls.share, i, share + stepLength * (at.wall - share) / at.divisor);
  }
};

/// A plain iteration. The first one starts without displacements, the last one ends in positions and
/// velocities, so that a step needs no other passes for these.
template <class Weight>
struct Substitute {
  // The search for neighbours comes before the first, and a sum of densities before the others.
  static constexpr Standing kLeaves = Standing::kLists,
                            kReadsAhead = Weight::kFirst ? Standing::kCounts : Standing::kLists;
  static constexpr int kBlocksTogether = 6;
  PushOf pushOf;
  Weight weight;
  float inverseDt;
  ArrayView<Vec3f> positions, velocities;  // predicted until the last iteration
  ArrayView<Vec3f> displacement;
  ArrayView<Vec4f> state;
  MotionCode code;
  bool begins = false, ends = false, storesCodes = false;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    using Vector = Vec3<NumberAt<Index>>;
    const bool first = Weight::kFirst || begins, last = !Weight::kFirst && ends;
    // A team is few threads that wait for memory most of the time; others have no registers to spare.
    constexpr bool kEarly = std::is_same_v<Index, TeamIndex>;
    Vector u, predicted, velocity;
    if constexpr (kEarly) {
      if (!first) u = readAhead(displacement, i);
      predicted = readAhead(positions, i);
      if (last) velocity = readAhead(velocities, i);
    }
    const auto at = pushOf(i, weight);
    if constexpr (!kEarly)
      if (!first) u = read(displacement, i);
    const auto moved = u + (at.push - u) / at.divisor;
    pushOf.followWalls(i, at);
    if constexpr (!kEarly) predicted = read(positions, i);
    const auto p = predicted + moved;
    if (last) {
      write(positions, i, p);
      if constexpr (!kEarly) velocity = read(velocities, i);
      const auto v = velocity + inverseDt * moved;
      write(velocities, i, v);
      if constexpr (std::is_same_v<Vector, Vec3f>)
        if (storesCodes) write(state, i, code.of(p, v));
    } else {
      write(displacement, i, moved);
      write(state, i, {p.x, p.y, p.z, 0});
    }
  }
};

// ---- What tolerance, acceleration and step-length search add

/// f, unless the pass is done.
template <class F>
struct UnlessDone {
  F f;
  const int* done;  // null where nobody knows

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    if (done == nullptr || !*done) f(i);
  }
};

using Control = SemiImplicitSolver::Control;
using Sums = SemiImplicitSolver::Sums;

/// E_i, and |g_i·Δx_i| where a step is proposed.
struct Measure {
  BulkEnergy energy;
  float stiffness;  // (c·dt)²
  ArrayView<const Vec3f> displacement;
  ArrayView<const float> excess;
  ArrayView<const Vec4f> proposal;  // may be empty
  ArrayView<const Vec3f> searched;  // displacements at the search; all 0 if it is empty

  WEIR_HD Sums operator()(std::int64_t i) const {
    const Vec3f u = displacement[i];
    const float e = excess[i];
    const Vec3f way = searched.size > 0 ? u - searched[i] : u;
    return {e > 0 ? double(e) : 0.0, 0.5 * double(dot(u, u)) + double(stiffness) * double(energy.value(e)),
            proposal.size > 0 ? double(proposal[i].w) : 0.0, double(dot(way, way))};
  }
};

/// Δx of full length, and |g·Δx| = |g|²/divisor.
struct Propose {
  PushOf pushOf;
  ArrayView<const Vec3f> displacement;
  ArrayView<Vec4f> proposal;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    const auto at = pushOf(i);
    const auto descent = at.push - read(displacement, i);
    const auto step = descent / at.divisor;
    write(proposal, i, {step.x, step.y, step.z, dot(descent, step)});
  }
};

WEIR_HD float stepLengthOf(const Sums& sums) {
  return sums.objective < sums.slope ? float(sums.objective / sums.slope) : 1.0f;
}

/// An update by what was proposed or, without a search, by what Substitute would do.
struct Update {
  PushOf pushOf;
  StepLength stepLength;
  Measure measure;
  const Sums* sums;
  const Control* control;  // null without tolerance and acceleration
  ArrayView<const Vec3f> predicted;
  ArrayView<Vec3f> displacement;
  ArrayView<Vec4f> state;
  AndersonHistory history;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    if (control != nullptr && (control->done || control->takesBack)) return;
    if (stepLength == StepLength::kFull)
      move(i, [this](const auto& one, const auto& u) { return fullStep(one, u); });
    else
      forEachOf(i, [this](std::int64_t one) {
        move(one, [this](std::int64_t k, const Vec3f&) { return searchedStep(k); });
      });
  }

  template <class Index, class Step>
  WEIR_HD void move(Index i, const Step& step) const {
    const auto u = read(displacement, i);
    if (!history.empty()) write(history.startsOf(control->entry), i, u);
    const auto moved = u + step(i, u);
    write(displacement, i, moved);
    const auto p = read(predicted, i) + moved;
    write(state, i, {p.x, p.y, p.z, 0});
  }

  template <class Index, class T>
  WEIR_HD Vec3<T> fullStep(Index i, const Vec3<T>& u) const {
    const auto at = pushOf(i);
    pushOf.followWalls(i, at);
    return (at.push - u) / at.divisor;
  }

  WEIR_HD Vec3f searchedStep(std::int64_t i) const {
    const float alpha = stepLengthOf(stepLength == StepLength::kGlobal ? *sums : measure(i));
    const WallFieldView& walls = pushOf.walls;
    if (!walls.empty() && walls.d[i] > 0) pushOf.followWalls(i, pushOf(i), alpha);
    return alpha * xyz(measure.proposal[i]);
  }
};

/// Goes on along the change since the last plain update, or back to it.
struct Extrapolate {
  const Control* control;
  ArrayView<Vec3f> plain;
  ArrayView<float> plainShare;  // of the walls; empty without them
  ArrayView<const Vec3f> predicted;
  ArrayView<Vec3f> displacement;
  ArrayView<float> share;
  ArrayView<Vec4f> state;

  WEIR_HD void operator()(std::int64_t i) const {
    if (control->done) return;
    if (plainShare.size > 0) share[i] = extrapolated(plainShare[i], share[i]);
    const Vec3f u = displacement[i], moved = extrapolated(plain[i], u);
    if (moved == u) return;
    displacement[i] = moved;
    const Vec3f p = predicted[i] + moved;
    state[i] = {p.x, p.y, p.z, 0};
  }

  template <class T>
  WEIR_HD T extrapolated(T& before, const T& now) const {
    if (control->takesBack) return before;
    // Nothing is before the first.
    const T moved = control->momentum == 0 ? now : now + control->momentum * (now - before);
    before = now;
    return moved;
  }
};

/// What walls do to the velocities beside holding the fluid: bounce and friction.
struct MeetWalls {
  PushOf pushOf;
  BoundaryView boundary;
  float reach;  // m, at which a wall holds a particle
  float inverseDt;
  ArrayView<const Vec3f> positions;
  ArrayView<const Vec3f> displacement;
  ArrayView<Vec3f> velocities;

#ifdef WEIR_HAS_EIGHT
  void operator()(Eight i) const {
    forEachNear(boundary, reach, i, read(positions, i), *this);
  }
#endif

  WEIR_HD void operator()(std::int64_t i) const {
    const BoundaryHit wall = boundaryQuery(boundary, positions[i]);
    if (!(wall.distance < reach)) return;
    // Whatever moved a particle beside the fluid's push is the wall.
    const Vec3f u = displacement[i], v = velocities[i];
    const float held = inverseDt * dot(u - pushOf(i).push, wall.normal);
    if (!(held > 0)) return;
    velocities[i] = heldByWall(v, wall, -dot(v - inverseDt * u, wall.normal), held);
  }
};

float stiffnessOf(const FluidStep& fluid) {
  const float dt = static_cast<float>(fluid.time.dt);
  return fluid.constants.soundSpeedSquared() * dt * dt;
}

/// The displacement x − x*. The first one takes the place of the crowding.
Array<Vec3f>& displacement(FluidStep& fluid) {
  return fluid.particles.scratch();
}

/// Positions, in the iterations.
ArrayView<Vec4f> places(FluidStep& fluid) {
  return fluid.particles.places().view();
}

/// Position and Ḃ of each particle, after the density pass.
Array<Vec4f>& weighted(FluidStep& fluid) {
  return fluid.particles.wideScratch();
}

PushOf makePushOf(FluidStep& fluid, bool conservative, const BulkEnergy& energy) {
  constexpr float kShortest = 1e-4f;  // spacings
  const FluidConstants& c = fluid.constants;
  return {fluid.neighbors.view(),
          c.kernel,
          stiffnessOf(fluid) * c.particleVolume,
          kShortest * c.spacing,
          1.0f,
          conservative ? 1.0f : 0.0f,
          energy.negativePart(),
          stiffnessOf(fluid),
          fluid.walls.view(),
          weighted(fluid).view()};
}

}  // namespace

template <class Backend>
void SemiImplicitSolver::stepOn(Backend& device, FluidStep& fluid) {
  reserve(fluid);
  fluid.walls.forgetShares();
  if (isPlain()) return substitute(device, fluid);
  const Count count = fluid.particles.count();
  beginStep(device, fluid);
  start(device, fluid);
  contain(device, fluid);
  if (recordObjective) objective_->begin(fluid, maxPasses() * iterations + 1);
  record(fluid);
  for (int pass = 0; pass < maxPasses() && !over_; ++pass) {
    if (pass > 0) searchAgain(device, fluid);
    iterate(device, fluid, pass);
  }
  ArrayView<Vec3f> velocities = fluid.particles.velocities().view();
  const float inverseDt = 1 / static_cast<float>(fluid.time.dt);
  parallelFor(device, "finish", count,
              FinishDisplacement{inverseDt, displacement(fluid).view(), fluid.particles.positions().view(),
                                 velocities});
  if (!controlled()) return;
  constexpr float kTouching = 1.001f;
  for (const Boundary* boundary : fluid.boundaries)
    parallelForEights(device, "walls", count,
                      MeetWalls{makePushOf(fluid, conservative, bulkEnergy_), boundary->view(),
                                kTouching * fluid.constants.contact, inverseDt,
                                fluid.particles.positions().view(), displacement(fluid).view(), velocities});
}

template <class Backend>
void SemiImplicitSolver::start(Backend& device, FluidStep& fluid) {
  parallelFor(
      device, "start", fluid.particles.count(),
      StartDisplacement{fluid.particles.positions().view(), places(fluid), displacement(fluid).view()});
}

template <class Backend>
void SemiImplicitSolver::beginStep(Backend& device, FluidStep& fluid) {
  if (!controlled()) return;
  const Count count = fluid.particles.count();
  const float dt = static_cast<float>(fluid.time.dt);
  const ArrayView<const Vec3f> velocities = fluid.particles.velocities().view();
  over_ = false;
  if (staged(fluid))
    reduce(device, "farthest", count, 0.0f, detail::SquareOfWay{dt, velocities}, Max{}, farthest_.data());
  constexpr float kStage = 1;  // spacings
  parallelFor(device, "begin", 1,
              detail::BeginStep{control_->data(), staged(fluid) ? farthest_.data() : nullptr, dt,
                                kStage * fluid.constants.spacing, pathStages});
  if (staged(fluid))
    parallelFor(device, "go back", count,
                detail::GoBack{control_->data(), velocities, fluid.particles.positions().view()});
}

template <class Backend>
void SemiImplicitSolver::substitute(Backend& device, FluidStep& fluid) {
  // First of all, as displacements and positions take their place.
  const ArrayView<const float> crowding = fluid.neighbors.crowding(fluid.particles);
  const ArrayView<const Vec4f> found = fluid.neighbors.places(fluid.particles);
  const Count count = fluid.particles.count();
  const FluidConstants& c = fluid.constants;
  const ArrayView<Vec3f> positions = fluid.particles.positions().view();
  // The search knows neither walls nor what they hide from each other.
  const bool begun = fluid.walls.empty() && found.size > 0;
  const bool searched = fluid.walls.empty() && crowding.size > 0;
  // What the search has written is the first of what neighbours are asked for.
  const ArrayView<Vec4f> states = begun ? weighted(fluid).view() : fluid.particles.places().view();
  const ArrayView<Vec4f> weights = begun ? fluid.particles.places().view() : weighted(fluid).view();
  const EnergyDerivative derivative{
      fluid.neighbors.view(),     c.kernel, c.particleVolume, bulkEnergy_, tension, fluid.walls.view(),
      displacement(fluid).view(), states,   weights,          {}};
  PushOf pushOf = makePushOf(fluid, conservative, bulkEnergy_);
  pushOf.weighted = weights;
  const float volumeAtZero = c.particleVolume * c.kernel.value0;
  Substitute<detail::AsStored> update{pushOf,
                                      {},
                                      1 / static_cast<float>(fluid.time.dt),
                                      positions,
                                      fluid.particles.velocities().view(),
                                      displacement(fluid).view(),
                                      states,
                                      MotionCode(c.supportRadius)};
  update.storesCodes = fluid.particles.motionCodesRequested() && fluid.device.kind() == DeviceKind::kCuda;
  if (!begun && !searched) start(device, fluid);
  for (int k = 0; k < iterations; ++k) {
    update.begins = k == 0;
    update.ends = k + 1 == iterations;
    if constexpr (std::is_same_v<Backend, CudaDevice>) {
      if (update.begins && begun && bulkEnergy_.isQuadratic() && !update.ends) {
        const float least = tension ? std::numeric_limits<float>::lowest() : 0.0f;
        const detail::OfCrowding weight{volumeAtZero, least, bulkEnergy_.derivative(1.0f)};
        parallelForSums(
            device, "substitute", count,
            Substitute<detail::OfCrowding>{pushOf, weight, update.inverseDt, positions, update.velocities,
                                           update.displacement, states, update.code});
        continue;
      }
    }
    if (update.begins && begun)
      parallelFor(device, "density", count,
                  detail::DerivativeOfPlace{volumeAtZero, bulkEnergy_, tension, weights});
    else if (update.begins && searched)
      parallelForEights(
          device, "density", count,
          detail::FirstDerivative{volumeAtZero, bulkEnergy_, tension, positions, crowding, weights});
    else
      parallelForSums(device, "density", count, derivative);
    parallelForSums(device, "substitute", count, update);
  }
  if (update.storesCodes) fluid.particles.storeMotionCodes(states);
}

template <class Backend>
void SemiImplicitSolver::iterate(Backend& device, FluidStep& fluid, int pass) {
  const Count count = fluid.particles.count();
  const FluidConstants& c = fluid.constants;
  const ArrayView<const Vec3f> predicted = fluid.particles.positions().view();
  const PushOf pushOf = makePushOf(fluid, conservative, bulkEnergy_);
  UnlessDone<EnergyDerivative> derivative{
      {fluid.neighbors.view(), c.kernel, c.particleVolume, bulkEnergy_, tension, fluid.walls.view(),
       displacement(fluid).view(), places(fluid), weighted(fluid).view(), excess_.view()},
      nullptr};
  const Measure measure{bulkEnergy_,
                        stiffnessOf(fluid),
                        displacement(fluid).view(),
                        excess_.view(),
                        searches() ? proposal_.view() : ArrayView<Vec4f>{},
                        pass > 0 ? carried_->view() : ArrayView<Vec3f>{}};
  const Update update{pushOf,
                      stepLength,
                      measure,
                      sums_.data(),
                      controlled() ? control_->data() : nullptr,
                      predicted,
                      displacement(fluid).view(),
                      places(fluid),
                      mixing_.view()};
  constexpr double kReach = 0.25;  // spacings
  // The best mixture meets it before particles have come to rest; energy that should be lost is then left.
  constexpr int kMixturesUntilConverged = 3;
  const double reach = kReach * fluid.constants.spacing;
  detail::Judge judge{control_->data(),
                      sums_.data(),
                      count,
                      double(tolerance.get().value_or(-1.0f)),
                      mixes() ? kMixturesUntilConverged : 1,
                      accelerated(),
                      mixes(),
                      reach * reach,
                      maxRepeats(),
                      passes(),
                      false};
  if (controlled()) parallelFor(device, "begin", 1, detail::BeginPass{control_->data()});
  ++passes_;
  for (int k = 0; k < iterations && !isDone(); ++k) {
    // Walls may have moved particles since the pass was done, and what was found before that counts; how many
    // iterations come until the host hears of the end must not.
    if (controlled() && k > 0) derivative.done = &control_->data()->done;
    parallelForEights(device, "density", count, derivative);
    if (searches())
      parallelForEights(device, "propose", count,
                        Propose{pushOf, displacement(fluid).view(), proposal_.view()});
    if (controlled() || stepLength == StepLength::kGlobal)
      reduce(device, "measure", count, Sums{}, measure, AddSums{}, sums_.data());
    if (controlled()) {
      judge.last = k + 1 == iterations;
      parallelFor(device, "judge", 1, judge);
      controlSeen_->request(control_->data());
    }
    parallelForEights(device, "update", count, update);
    // The host may hear of the end of a pass, and of all passes, some iterations later.
    const Control* control = control_->data();
    const int* done = !controlled() ? nullptr : k > 0 ? &control->done : &control->surplus;
    contain(device, fluid, done);
    record(fluid);
    if (!accelerated()) continue;
    if (mixes())
      mixing_.mix(device, count, control_->data(),
                  {displacement(fluid).view(), fluid.walls.view().share, predicted, places(fluid)});
    else
      parallelFor(device, "extrapolate", count,
                  Extrapolate{control_->data(), plain_.view(),
                              fluid.walls.empty() ? ArrayView<float>{} : plainShare_.view(), predicted,
                              displacement(fluid).view(), fluid.walls.view().share, places(fluid)});
    contain(device, fluid, done);
  }
  endPass(pass);
}

template <class Backend>
void SemiImplicitSolver::contain(Backend& device, FluidStep& fluid, const int* done) {
  if (!controlled()) return;
  for (const Boundary* boundary : fluid.boundaries)
    parallelForEights(device, "contain", fluid.particles.count(),
                      Contain{boundary->view(), fluid.constants.contact, fluid.particles.positions().view(),
                              displacement(fluid).view(), places(fluid), done});
}

template <class Backend>
void SemiImplicitSolver::searchAgain(Backend& device, FluidStep& fluid) {
  parallelFor(
      device, "move", fluid.particles.count(),
      detail::MoveOut{control_->data(), displacement(fluid).view(), fluid.particles.velocities().view(),
                      carried_->view(), fluid.particles.positions().view()});
  fluid.neighbors.build(fluid.particles, fluid.domain, fluid.sinks);
  fluid.findWalls();
  // The sort has put the particles, and what is carried, into another order and other memory.
  parallelFor(device, "move", fluid.particles.count(),
              detail::MoveBack{carried_->view(), displacement(fluid).view(),
                               fluid.particles.positions().view(), places(fluid)});
  if (fluid.walls.empty()) return;
  fluid.walls.base = std::as_const(*carried_).view();
  fluid.walls.keepLegal(fluid.particles.positions());
}

template void SemiImplicitSolver::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
