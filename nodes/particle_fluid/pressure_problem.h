// The problem that a pressure solver solves in each step, and the two sums over neighbours that it takes:
// of all displacements u = x − x* from the predicted positions, the one with the least
//
//   Σ_i E_i,   E_i = |u_i|²/2 + (c·dt)²·B(λ_i)
//
// (the paper's Eq. 7, over m/dt²). The density pass gives λ and Ḃ(λ); the push gives the bracket and the
// divisor of Eq. 14. Walls add Φ to λ and ∇Φ to the push, see wall_field.h.
#pragma once

#include "nodes/particle_fluid/bulk_energy.h"
#include "nodes/particle_fluid/density.h"
#include "nodes/particle_fluid/displacement.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

/// e = λ − 1, where it counts.
template <class T>
WEIR_HD T excessOf(const T& lambda, bool tension) {
  return tension ? lambda - 1 : positivePart(lambda - 1);
}

/// The density pass: adds to each particle's state Ḃ(λ), the derivative of the bulk energy.
template <class Walls>
struct EnergyDerivativeWith {
  NeighborView neighbors;
  SpikyKernel kernel;
  float particleVolume;
  BulkEnergy energy;
  bool tension;
  Walls walls;
  ArrayView<const Vec4f> state;
  ArrayView<Vec4f> weighted;
  ArrayView<float> excess;  // empty where nobody asks for it

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    auto lambda = relativeDensity(i, neighbors, kernel, particleVolume, state);
    const auto s = read(state, i);
    if (!walls.empty()) lambda += walls.phi(i, xyz(s));
    const auto e = excessOf(lambda, tension);
    write(weighted, i, {s.x, s.y, s.z, energy.derivative(e)});
    if (excess.size > 0) write(excess, i, e);
  }
};
using EnergyDerivative = EnergyDerivativeWith<WallFieldView>;

/// What pushes a particle, and how far it may go: the bracket of Eq. 14 is `push` - displacement.
template <class T>
struct Push {
  Vec3<T> push;
  T divisor;
  T wall;           // of the push, what goes into the share of walls
  Vec3<T> byWalls;  // the part that comes from walls
};

template <class Walls>
struct PushWith {
  NeighborView neighbors;
  SpikyKernel kernel;
  float stiffness;      // (c·dt)²·V0
  float shortest;       // m; closer pairs are treated as this far apart, along their direction
  float own, others;    // weights of Ḃ_i and Ḃ_j
  float negativePart;   // |Ḃ⁻|
  float wallStiffness;  // (c·dt)²
  Walls walls;
  ArrayView<const Vec4f> weighted;

  // Inline, so that what is the same for all particles is prepared once for all.
  template <class Index>
  [[gnu::always_inline]] WEIR_HD Push<NumberAt<Index>> operator()(Index i) const {
    const auto list = neighborsOf(i, neighbors);
    const auto s = read(weighted, i);
    const auto ownWeight = own * s.w;
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
      const T b = (ownWeight + others * t.w) * a;
      return Vec4<T>{b * d.x, b * d.y, b * d.z, a};
    };
    const auto sum = sumOverNeighbors<Vec4f>(list, pairPush, weighted);
    Push<NumberAt<Index>> total{-xyz(sum), 1 + (own + others) * negativePart * sum.w, 0, {}};
    if (!walls.empty()) addWalls(i, xyz(s), s.w, total);
    return total;
  }

  /// The gradient of what walls add to the energy: with λ it depends on the particle's own place alone.
  template <class Index, class T>
  WEIR_HD void addWalls(Index i, const Vec3<T>& x, const T& derivative, Push<T>& total) const {
    const WallPush<T> wall = walls.push(i, x);
    if (!any(wall.d > T(0))) return;
    const T push = zeroUnless(wall.d > T(0), -derivative * wallStiffness);
    total.wall = wall.steepness * push;
    total.byWalls = push * wall.gradPhi;
    total.push += total.byWalls;
    total.divisor += negativePart * wallStiffness * wall.d;
  }

  /// Moves the share of the walls in the displacement like the displacement itself.
  template <class Index, class T>
  WEIR_HD void followWalls(Index i, const Push<T>& at, float stepLength = 1) const {
    if (walls.share.size == 0) return;
    const T share = read(walls.share, i);
    write(walls.share, i, share + stepLength * (at.wall - share) / at.divisor);
    if (walls.grip.size == 0) return;
    const T follows = T(stepLength * negativePart * wallStiffness) / at.divisor;
    write(walls.grip, i, zeroUnless(at.wall * at.wall > T(0), follows));
  }
};
using PushOf = PushWith<WallFieldView>;

/// What the search for neighbours has left (neighbor_list.h), where it says what a solver asks.
struct SearchSums {
  ArrayView<const float> crowding;
  ArrayView<const Vec4f> places;

  static SearchSums of(const FluidStep& fluid) {
    // The search does not know what meshes hide from each other.
    if (!fluid.walls.empty()) return {};
    const ByProducts& found = fluid.particles.byProducts();
    return {.crowding = found.find(kCrowding), .places = found.find(kPlaces)};
  }
  bool empty() const { return places.size == 0 && crowding.size == 0; }
};

/// Of one step; all arrays are the particles' own scratch memory.
struct PressureProblem {
  FluidStep& fluid;
  const BulkEnergy& energy;
  bool conservative, tension;
  /// `crowding` stands where displacements go, `places` where states go, so it is over with the first of
  /// these that is written. Members are made in their order: this one before the rooms are leased.
  SearchSums found = SearchSums::of(fluid);
  Lease<Vec3f> displacementRoom = fluid.particles.leaseVectors();
  Lease<Vec4f> stateRoom = fluid.particles.leasePlaces();
  Lease<Vec4f> weightedRoom = fluid.particles.leaseWide();

  /// (c·dt)².
  float stiffness() const {
    const float dt = static_cast<float>(fluid.time.dt);
    return fluid.constants.soundSpeedSquared() * dt * dt;
  }
  /// What squares of displacements are measured against, m².
  double square() const { return double(fluid.constants.spacing) * double(fluid.constants.spacing); }
  float inverseDt() const { return 1 / static_cast<float>(fluid.time.dt); }
  ArrayView<const Vec3f> predicted() const { return fluid.particles.positions().read(); }
  /// x − x*.
  ArrayView<Vec3f> displacement() const { return displacementRoom.view(); }
  /// Positions, in the iterations.
  ArrayView<Vec4f> state() const { return stateRoom.view(); }
  /// Position and Ḃ of each particle, after the density pass.
  ArrayView<Vec4f> weighted() const { return weightedRoom.view(); }
  /// Calls f, which may put the particles into another order, with all rooms given back. What was in them is
  /// lost.
  template <class F>
  void withoutRooms(const F& f) {
    displacementRoom = {}, stateRoom = {}, weightedRoom = {};
    f();
    displacementRoom = fluid.particles.leaseVectors();
    stateRoom = fluid.particles.leasePlaces();
    weightedRoom = fluid.particles.leaseWide();
  }

  /// The density pass, which leaves e where it is asked for.
  EnergyDerivative derivative(ArrayView<float> excess = {}) const {
    return derivativeWith(fluid.walls.view(), excess);
  }
  PushOf push() const { return pushWith(fluid.walls.view()); }
  /// The same with one of the views of WallField::withView().
  template <class Walls>
  EnergyDerivativeWith<Walls> derivativeWith(const Walls& walls, ArrayView<float> excess = {}) const {
    return {.neighbors = fluid.neighbors.view(),
            .kernel = fluid.constants.kernel,
            .particleVolume = fluid.constants.particleVolume,
            .energy = energy,
            .tension = tension,
            .walls = walls,
            .state = state(),
            .weighted = weighted(),
            .excess = excess};
  }
  template <class Walls>
  PushWith<Walls> pushWith(const Walls& walls) const {
    constexpr float kShortest = 1e-4f;  // spacings
    return {.neighbors = fluid.neighbors.view(),
            .kernel = fluid.constants.kernel,
            .stiffness = stiffness() * fluid.constants.particleVolume,
            .shortest = kShortest * fluid.constants.spacing,
            .own = 1,
            .others = conservative ? 1.0f : 0.0f,
            .negativePart = energy.negativePart(),
            .wallStiffness = stiffness(),
            .walls = walls,
            .weighted = weighted()};
  }
  /// Displacements of 0.
  template <class Backend>
  void start(Backend& device) const {
    parallelFor(device, "start", fluid.particles.count(),
                StartDisplacement{predicted(), state(), displacement()});
  }
  /// The end of the step, from the displacements.
  template <class Backend>
  void finish(Backend& device) const {
    parallelFor(device, "finish", fluid.particles.count(),
                FinishDisplacement{inverseDt(), displacement(), fluid.particles.positions().write(),
                                   fluid.particles.velocities().write()});
  }
};

}  // namespace weir
