#include "nodes/particle_fluid/modules/semi_implicit_solver.h"

#include "nodes/particle_fluid/density.h"
#include "nodes/particle_fluid/displacement.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

namespace {

/// Adds to each particle's state Ḃ(λ), the derivative of the bulk energy.
struct EnergyDerivative {
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

  WEIR_HD void operator()(std::int64_t i) const {
    float lambda = relativeDensity(i, neighbors, kernel, particleVolume,
                                   [this](std::int64_t j) { return xyz(state[j]); });
    if (!walls.empty()) lambda += walls.phi(i, displacement[i]);
    const float e = (tension || lambda > 1) ? lambda - 1 : 0.0f;
    const Vec4f s = state[i];
    weighted[i] = {s.x, s.y, s.z, energy.derivative(e)};
    if (excess.size > 0) excess[i] = e;
  }
};

/// What pushes a particle, and how far it may go: the bracket of the class comment is `push` - displacement.
struct Push {
  Vec3f push;
  float divisor;
  float wall;  // the part wall·∇Φ of the push comes from walls
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

  WEIR_HD Push operator()(std::int64_t i) const {
    const Vec4f s = weighted[i];
    Vec3f push{};
    float sum = 0;
    forEachNeighbor(i, neighbors, [&](int j) {
      const Vec4f t = weighted[j];
      Vec3f d = xyz(t) - xyz(s);
      float r = sqrtf(dot(d, d));
      if (r < shortest) {
        // Particles in one place would stay there for ever; the sign makes the two directions opposite.
        if (r == 0) d.x = j > i ? shortest : -shortest;
        r = shortest;
      }
      const float a = stiffness * kernel.slope(r) / r;
      push -= (own * s.w + others * t.w) * a * d;
      sum += a;
    });
    Push total{push, 1 + (own + others) * negativePart * sum, 0};
    if (!walls.empty()) addWalls(i, s.w, total);
    return total;
  }

  /// Mirrored fluid, whose Ḃ is the particle's own.
  WEIR_HD void addWalls(std::int64_t i, float derivative, Push& total) const {
    const float d = walls.d[i];
    if (!(d > 0)) return;
    total.wall = -(own + others) * derivative * wallStiffness;
    total.push += total.wall * walls.gradient(i);
    total.divisor += (own + others) * negativePart * wallStiffness * d;
  }

  /// Moves the share of the walls in the displacement like the displacement itself.
  WEIR_HD void followWalls(std::int64_t i, const Push& at) const {
    if (!walls.empty()) walls.share[i] += (at.wall - walls.share[i]) / at.divisor;
  }
};

struct Substitute {
  PushOf pushOf;
  ArrayView<const Vec3f> predicted;
  ArrayView<Vec3f> displacement;
  ArrayView<Vec4f> state;

  WEIR_HD void operator()(std::int64_t i) const {
    const Push at = pushOf(i);
    const Vec3f u = displacement[i];
    const Vec3f moved = u + (at.push - u) / at.divisor;
    pushOf.followWalls(i, at);
    displacement[i] = moved;
    const Vec3f p = predicted[i] + moved;
    state[i] = {p.x, p.y, p.z, 0};
  }
};

// ---- What tolerance, acceleration and step-length search add

using Control = SemiImplicitSolver::Control;
using Sums = SemiImplicitSolver::Sums;

struct BeginStep {
  Control* control;

  WEIR_HD void operator()(std::int64_t) const {
    control->done = 0;
    control->iterations = 0;
    control->sinceRestart = 0;
    control->objective = 0;
    ++control->steps;
  }
};

/// E_i, and |g_i·Δx_i| where a step is proposed.
struct Measure {
  BulkEnergy energy;
  float stiffness;  // (c·dt)²
  ArrayView<const Vec3f> displacement;
  ArrayView<const float> excess;
  ArrayView<const Vec4f> proposal;  // may be empty

  WEIR_HD Sums operator()(std::int64_t i) const {
    const Vec3f u = displacement[i];
    const float e = excess[i];
    return {e > 0 ? double(e) : 0.0, 0.5 * double(dot(u, u)) + double(stiffness) * double(energy.value(e)),
            proposal.size > 0 ? double(proposal[i].w) : 0.0};
  }
};

struct Add {
  WEIR_HD Sums operator()(const Sums& a, const Sums& b) const {
    return {a.compression + b.compression, a.objective + b.objective, a.slope + b.slope};
  }
};

/// Whether to go on, and with which weight: ω₁ = 1, ω₂ = 2/(2 − p²), ω_k+1 = 4/(4 − p²·ω_k).
struct Judge {
  Control* control;
  const Sums* sums;
  Count count;
  double tolerance;      // below 0: never done
  float spectralRadius;  // p

  WEIR_HD void operator()(std::int64_t) const {
    if (control->done) return;
    const std::int64_t particles = count.get();
    const double mean = particles > 0 ? sums->compression / double(particles) : 0.0;
    // An acceleration that overshoots starts anew with a plain iteration, which always descends. Overshooting
    // can also tear the fluid apart, so little compression alone does not mean that it is done.
    const bool rose = control->sinceRestart > 0 && sums->objective > control->objective;
    if (mean <= tolerance && !rose) {
      control->done = 1;
      return;
    }
    if (rose) control->sinceRestart = 0;
    const float p2 = spectralRadius * spectralRadius;
    const int k = control->sinceRestart++;
    control->omega = k == 0 ? 1.0f : k == 1 ? 2 / (2 - p2) : 4 / (4 - p2 * control->omega);
    control->objective = sums->objective;
    ++control->iterations;
    ++control->total;
    if (control->iterations > control->most) control->most = control->iterations;
  }
};

/// Δx of full length, and |g·Δx| = |g|²/divisor.
struct Propose {
  PushOf pushOf;
  ArrayView<const Vec3f> displacement;
  ArrayView<Vec4f> proposal;

  WEIR_HD void operator()(std::int64_t i) const {
    const Push at = pushOf(i);
    const Vec3f descent = at.push - displacement[i];
    const Vec3f step = descent / at.divisor;
    proposal[i] = {step.x, step.y, step.z, dot(descent, step)};
  }
};

WEIR_HD float stepLengthOf(const Sums& sums) {
  return sums.objective < sums.slope ? float(sums.objective / sums.slope) : 1.0f;
}

/// An update by what was proposed or, without a search, by what Substitute would do; weighted against the
/// displacement of the iteration before.
struct Update {
  PushOf pushOf;
  StepLength stepLength;
  Measure measure;
  const Sums* sums;
  const Control* control;  // null without tolerance and acceleration
  ArrayView<Vec3f> earlier;
  ArrayView<const Vec3f> predicted;
  ArrayView<Vec3f> displacement;
  ArrayView<Vec4f> state;

  WEIR_HD void operator()(std::int64_t i) const {
    if (control != nullptr && control->done) return;
    const Vec3f u = displacement[i];
    Vec3f moved = u + step(i, u);
    if (earlier.size > 0) {
      if (control->sinceRestart > 1) moved = earlier[i] + control->omega * (moved - earlier[i]);
      earlier[i] = u;
    }
    displacement[i] = moved;
    const Vec3f p = predicted[i] + moved;
    state[i] = {p.x, p.y, p.z, 0};
  }

  WEIR_HD Vec3f step(std::int64_t i, const Vec3f& u) const {
    if (stepLength == StepLength::kFull) {
      const Push at = pushOf(i);
      return (at.push - u) / at.divisor;
    }
    const float alpha = stepLengthOf(stepLength == StepLength::kGlobal ? *sums : measure(i));
    return alpha * xyz(measure.proposal[i]);
  }
};

/// The share of the walls in displacements that have converged: what they push in the end.
struct ConvergedShare {
  PushOf pushOf;
  WEIR_HD void operator()(std::int64_t i) const { pushOf.walls.share[i] = pushOf(i).wall; }
};

}  // namespace

template <class Backend>
void SemiImplicitSolver::stepOn(Backend& device, FluidStep& fluid) {
  reserve(fluid);
  constexpr float kShortest = 1e-4f;  // spacings
  const Count count = fluid.particles.count();
  const FluidConstants& c = fluid.constants;
  const float dt = static_cast<float>(fluid.time.dt);
  const float stiffness = c.soundSpeedSquared() * dt * dt;
  const NeighborView neighbors = fluid.neighbors.view();
  const WallFieldView walls = fluid.walls.view();
  const ArrayView<Vec3f> predicted = fluid.particles.positions().view();
  const EnergyDerivative derivative{neighbors,        c.kernel,      c.particleVolume,     bulkEnergy_,
                                    tension,          walls,         displacement_.view(), state_.view(),
                                    weighted_.view(), excess_.view()};
  const PushOf pushOf{neighbors,
                      c.kernel,
                      stiffness * c.particleVolume,
                      kShortest * c.spacing,
                      1.0f,
                      conservative ? 1.0f : 0.0f,
                      bulkEnergy_.negativePart(),
                      stiffness,
                      walls,
                      weighted_.view()};

  parallelFor(device, "start", count, StartDisplacement{predicted, state_.view(), displacement_.view()});
  if (recordObjective) objective_.begin(fluid, iterations + 1);
  record(fluid);
  if (!controlled() && !searches()) {
    const Substitute substitute{pushOf, predicted, displacement_.view(), state_.view()};
    for (int k = 0; k < iterations; ++k) {
      parallelFor(device, "density", count, derivative);
      parallelFor(device, "substitute", count, substitute);
      record(fluid);
    }
  } else {
    const Measure measure{bulkEnergy_, stiffness, displacement_.view(), excess_.view(),
                          searches() ? proposal_.view() : ArrayView<Vec4f>{}};
    const Update update{pushOf,
                        stepLength,
                        measure,
                        sums_.data(),
                        controlled() ? control_.data() : nullptr,
                        accelerated() ? earlier_.view() : ArrayView<Vec3f>{},
                        predicted,
                        displacement_.view(),
                        state_.view()};
    const Judge judge{control_.data(), sums_.data(), count, double(tolerance.get().value_or(-1.0f)),
                      accelerated() ? spectralRadius.get() : 0.0f};
    if (controlled()) parallelFor(device, "begin", 1, BeginStep{control_.data()});
    ++steps_;
    for (int k = 0; k < iterations && !toleranceWasMet(); ++k) {
      parallelFor(device, "density", count, derivative);
      if (searches())
        parallelFor(device, "propose", count, Propose{pushOf, displacement_.view(), proposal_.view()});
      if (controlled() || stepLength == StepLength::kGlobal)
        reduce(device, "measure", count, Sums{}, measure, Add{}, sums_.data());
      if (controlled()) {
        parallelFor(device, "judge", 1, judge);
        controlSeen_->request(control_.data());
      }
      parallelFor(device, "update", count, update);
      record(fluid);
    }
    if (!walls.empty()) parallelFor(device, "wall share", count, ConvergedShare{pushOf});
  }
  parallelFor(
      device, "finish", count,
      FinishDisplacement{1 / dt, displacement_.view(), predicted, fluid.particles.velocities().view()});
}

template void SemiImplicitSolver::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
