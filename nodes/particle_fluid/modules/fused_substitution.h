// The iterations of SemiImplicitSolver in fewer passes over the particles, for speed alone; whoever reads for
// the method need not open this. The first iteration takes its densities from the kernel's sums that the
// search for neighbours has made on its way (SearchSums) and starts without
// displacements; the last one ends in positions and velocities, with the motion codes of those.
#pragma once

#include "framework/compute/eight.h"
#include "framework/compute/wide_access.h"
#include "framework/neighbors/motion_code.h"
#include "nodes/particle_fluid/pressure_problem.h"

namespace weir {

/// Makes positions weighted with Ḃ of what the search has summed.
template <class Walls>
struct FirstDerivative {
  float volumeAtZero;  // V0·W(0)
  BulkEnergy energy;
  bool tension;
  Walls walls;
  ArrayView<const Vec3f> predicted;
  ArrayView<const float> crowding;
  ArrayView<Vec4f> weighted;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    const auto p = read(predicted, i);
    auto lambda = volumeAtZero * read(crowding, i);
    if (!walls.empty()) lambda += walls.phi(i, p);
    const auto e = excessOf(lambda, tension);
    write(weighted, i, {p.x, p.y, p.z, energy.derivative(e)});
  }
};

/// The same where the search has left position and crowding, for CUDA.
template <class Walls>
struct DerivativeOfPlace {
  // It stands between the search and a sum that reads lists ahead.
  static constexpr Standing kLeaves = Standing::kLists, kReadsAhead = Standing::kCounts;
  float volumeAtZero;
  BulkEnergy energy;
  bool tension;
  Walls walls;
  ArrayView<Vec4f> places;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec4f at = loadWhole(places[i]);
    float lambda = volumeAtZero * at.w;
    if (!walls.empty()) lambda += walls.phi(i, xyz(at));
    storeWhole(places[i], {at.x, at.y, at.z, energy.derivative(excessOf(lambda, tension))});
  }
};

/// An iteration of SemiImplicitSolver. The first one starts without displacements, the last one ends in
/// positions and velocities, so that a step needs no other passes for these.
template <class Walls>
struct FusedSubstitute {
  PushWith<Walls> pushOf;
  float inverseDt;
  ArrayView<Vec3f> positions, velocities;  // predicted until the last iteration
  ArrayView<Vec3f> displacement;
  ArrayView<Vec4f> state;
  MotionCode code;
  bool begins = false, ends = false, storesCodes = false;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    using Vector = Vec3<NumberAt<Index>>;
    const auto before = besideSum(displacement, i, !begins);
    const auto predicted = besideSum(positions, i, !begins);
    const auto velocity = besideSum(velocities, i, ends);
    const auto at = pushOf(i);
    const Vector u = begins ? Vector{} : Vector(before());
    const auto moved = u + (at.push - u) / at.divisor;
    pushOf.followWalls(i, at);
    // At first particles are where they are predicted, which the sum has read.
    const auto p = (begins ? xyz(read(pushOf.weighted, i)) : Vector(predicted())) + moved;
    if (ends) {
      write(positions, i, p);
      const auto v = velocity() + inverseDt * moved;
      write(velocities, i, v);
      if (storesCodes) writeCode(state, i, code, p, v);
    } else {
      write(displacement, i, moved);
      write(state, i, {p.x, p.y, p.z, 0});
    }
  }
};

/// `Walls` is one of the views of WallField::withView().
template <class Backend, class Walls>
class FusedSubstitution {
 public:
  FusedSubstitution(Backend& device, const PressureProblem& problem, const Walls& walls)
      : device_(device),
        problem_(problem),
        walls_(walls),
        found_(problem.found),
        volumeAtZero_(problem.fluid.constants.particleVolume * problem.fluid.constants.kernel.value0),
        positions_(problem.fluid.particles.positions().write()),
        velocities_(problem.fluid.particles.velocities().write()),
        // What the search has written is the first of what neighbours are asked for.
        stateRoom_(hasPlaces() ? problem.weightedRoom : problem.stateRoom),
        state_(stateRoom_.view()),
        weighted_(hasPlaces() ? problem.state() : problem.weighted()) {}

  /// A step of iterations of full length.
  void step(int iterations) const {
    ParticleSet& particles = problem_.fluid.particles;
    ByProducts& byProducts = particles.byProducts();
    // Those of a halo are not exchanged.
    const bool hasHalo = isDivided() || problem_.fluid.images != nullptr;
    const bool codes =
        byProducts.isRequested(kMotionCodes) && !hasHalo && problem_.fluid.device.kind() == DeviceKind::kCuda;
    // A rank that has never had particles has no room for what the search finds, and does as the others.
    if (found_.empty() && (particles.capacity() > 0 || !problem_.fluid.walls.empty())) {
      problem_.start(device_);
      problem_.fluid.exchange(state_);
    }
    for (int k = 0; k < iterations; ++k) {
      const bool begins = k == 0, ends = k + 1 == iterations;
      if (begins)
        sumFirstDensities();
      else
        sumDensities();
      problem_.fluid.exchange(weighted_);
      auto update = substitute();
      update.begins = begins, update.ends = ends, update.storesCodes = codes;
      parallelForSums(device_, "substitute", count(), launched<ManyBlocks<SumAfterSum>>(update),
                      !isDivided());
      if (!ends) problem_.fluid.exchange(state_);
    }
    if (codes)
      byProducts.keep<Vec4f>(
          kMotionCodes, state_,
          {particles.positions().version(), particles.velocities().version(), stateRoom_.version()});
  }

 private:
  bool isDivided() const { return problem_.fluid.divided != nullptr; }
  bool hasPlaces() const { return found_.places.size > 0; }
  Count count() const { return problem_.fluid.particles.count(); }

  FusedSubstitute<Walls> substitute() const {
    PushWith<Walls> pushOf = problem_.pushWith(walls_);
    pushOf.weighted = weighted_;
    return {.pushOf = pushOf,
            .inverseDt = problem_.inverseDt(),
            .positions = positions_,
            .velocities = velocities_,
            .displacement = problem_.displacement(),
            .state = state_,
            .code = MotionCode(problem_.fluid.constants.supportRadius)};
  }

  void sumFirstDensities() const {
    const BulkEnergy& energy = problem_.energy;
    if (hasPlaces())
      parallelFor(device_, "density", count(),
                  DerivativeOfPlace<Walls>{.volumeAtZero = volumeAtZero_,
                                           .energy = energy,
                                           .tension = problem_.tension,
                                           .walls = walls_,
                                           .places = weighted_});
    else if (found_.crowding.size > 0)
      parallelForEights(device_, "density", count(),
                        FirstDerivative<Walls>{.volumeAtZero = volumeAtZero_,
                                               .energy = energy,
                                               .tension = problem_.tension,
                                               .walls = walls_,
                                               .predicted = positions_,
                                               .crowding = found_.crowding,
                                               .weighted = weighted_});
    else
      sumDensities();
  }

  void sumDensities() const {
    EnergyDerivativeWith<Walls> derivative = problem_.derivativeWith(walls_);
    derivative.state = state_, derivative.weighted = weighted_;
    parallelForSums(device_, "density", count(), launched<MaxBlocks<SumAfterSum>>(derivative), !isDivided());
  }

  Backend& device_;
  const PressureProblem& problem_;
  const Walls& walls_;
  const SearchSums& found_;
  float volumeAtZero_;
  ArrayView<Vec3f> positions_, velocities_;  // predicted until the last iteration
  const Lease<Vec4f>& stateRoom_;
  ArrayView<Vec4f> state_, weighted_;
};

}  // namespace weir
