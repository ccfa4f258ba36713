#include "nodes/particle_fluid/modules/viscosity_solver.h"

#include <algorithm>

#include "framework/compute/parallel_uneven.h"
#include "framework/compute/reductions.h"
#include "framework/neighbors/neighbor_sum.h"
#include "nodes/particle_fluid/displacement.h"
#include "nodes/particle_fluid/fluid_sums.h"
#include "nodes/particle_fluid/scratch.h"
#include "nodes/particle_fluid/solid_collision.h"
#include "nodes/particle_fluid/wall_field.h"
#include "nodes/static_boundary/boundary_clearance.h"

namespace weir {

namespace {

/// Where particles were at the beginning of the step, with the weight of their pairs; and velocities to start
/// from.
struct Begin {
  float dt;
  ArrayView<const Vec3f> positions, velocities, change;
  ArrayView<Vec4f> places;
  ArrayView<Vec3f> start;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f v = velocities[i], x = positions[i] - dt * v;
    places[i] = {x.x, x.y, x.z, 1};
    start[i] = v + change[i];
  }
};

/// K·u.
struct PairDrag {
  NeighborView neighbors;
  SpikyKernel kernel;
  float rate;      // 2(d + 2)·F·V0·ν·dt, m^5
  float shortest;  // m; closer pairs are treated as this far apart
  ArrayView<const Vec4f> places;

  template <class Index>
  [[gnu::always_inline]] WEIR_HD Vec3<NumberAt<Index>> operator()(Index i, ArrayView<const Vec3f> u) const {
    const auto place = read(places, i);
    const auto own = read(u, i);
    const auto drag = [&]<class T>(const auto&, const Vec4<T>& q, const Vec3<T>& other) {
      const Vec3<T> d{place.x - q.x, place.y - q.y, place.z - q.z};
      const T r2 = dot(d, d);
      const T near = fastSqrt(r2);
      const T r = select(near < T(shortest), T(shortest), near);
      const T weight = place.w + q.w;  // twice that of the pair
      const T along = dot(d, Vec3<T>{own.x - other.x, own.y - other.y, own.z - other.z});
      const T c = fastDivide(weight * kernel.slope(near), r * r * r) * along;
      return Vec4<T>{c * d.x, c * d.y, c * d.z, c};
    };
    return (0.5f * rate) * xyz(sumOverNeighbors<Vec4f>(i, neighbors, drag, places, u));
  }
};

/// v* − (1 + K + B)·v + B·v_w of the velocities to start from.
struct FirstResidual {
  PairDrag drag;
  WallDrag walls;
  ArrayView<const Vec3f> start, change;
  ArrayView<Vec3f> residual;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    auto r = -(drag(i, start) + read(change, i));
    if (!walls.empty()) r += read(walls.push, i) - walls(i, read(start, i));
    write(residual, i, r);
  }
};

/// The direction's image, (1 + K + B)·p.
struct Image {
  PairDrag drag;
  WallDrag walls;
  const ViscosityControl* control;
  ArrayView<const Vec3f> direction;
  ArrayView<Vec3f> image;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    if (control->done) return;
    const auto p = read(direction, i);
    auto q = drag(i, direction) + p;
    if (!walls.empty()) q += walls(i, p);
    write(image, i, q);
  }
};

/// What a plane at a distance of h does to a particle.
struct PlaneDrag {
  float radius;   // H, m
  float nearest;  // m; closer planes are treated as this far away
  float rate;     // of the drag, 1
  float gap;      // see gapFactor

  WEIR_HD float drag(float slip, float h) const { return rate * (1 - slip) * planeDrag(scaled(h)); }
  /// What the weight of its pairs gains.
  WEIR_HD float weight(float slip, float h) const {
    const float q = scaled(h), missing = shearBehind(q);
    return slip * missing / (1 - missing) + (1 - slip) * gap * kernelBehind(q);
  }

 private:
  WEIR_HD float scaled(float h) const { return (h > nearest ? h : nearest) / radius; }
};

/// Of solids given by signed distance.
struct DragOfBoundary {
  BoundaryView boundary;
  PlaneDrag plane;
  ArrayView<Vec4f> places;
  WallDrag walls;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = xyz(places[i]);
    if (!mayTouch(boundary, plane.radius, p)) return;
    forEachPiece(boundary, [&](const BoundaryPiece& piece) {
      forEachWall(piece, p, [&](float distance, const Vec3f& normal) {
        if (!(distance < plane.radius)) return;
        walls.add(i, plane.drag(piece.slip, distance), normal, {});
        places[i].w += plane.weight(piece.slip, distance);
      });
    });
  }
};

/// Of a solid given by a mesh: that of a plane, behind which there is as much of the kernel.
struct DragOfSolid {
  ArrayView<const SolidView> solids;
  SolidPairsView pairs;
  PlaneDrag plane;
  float wallRadius, wallFactor;  // of Φ
  ArrayView<const Vec3f> positions;
  ArrayView<const Vec4f> each;

  /// Calls f(k, strength, normal, velocity) for each solid k that drags particle i.
  template <class F>
  WEIR_HD void operator()(int i, const F& f) const {
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) {
      const int k = pairs.solid[pair];
      const Vec4f at = each[pair];
      const float steep = length(xyz(at));
      if (!(steep > 0) || solids[k].slip >= 1) continue;
      f(k, plane.drag(solids[k].slip, distanceOf(at.w)), xyz(at) / -steep,
        solids[k].velocityAt(positions[i]));
    }
  }
  WEIR_HD float weight(int i) const {
    float sum = 0;
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair)
      if (each[pair].w > 0) sum += plane.weight(solids[pairs.solid[pair]].slip, distanceOf(each[pair].w));
    return sum;
  }
  WEIR_HD float distanceOf(float phi) const { return planeOf(phi / wallFactor) * wallRadius; }
};

struct DragOfSolids {
  DragOfSolid drag;
  ArrayView<const int> near;
  ArrayView<Vec4f> places;
  WallDrag walls;

  WEIR_HD void operator()(std::int64_t n) const {
    const int i = near[n];
    places[i].w += drag.weight(i);
    drag(i, [&](int, float strength, const Vec3f& normal, const Vec3f& velocity) {
      walls.add(i, strength, normal, velocity);
    });
  }
};

/// What solids feel of it.
struct DragImpulse {
  DragOfSolid drag;
  ArrayView<const int> near;
  float mass;
  ArrayView<const Vec3f> velocities, change;

  template <class Give>
  WEIR_HD void operator()(std::int64_t n, const Give& give) const {
    const int i = near[n];
    const Vec3f v = velocities[i] + change[i], p = drag.positions[i];
    drag(i, [&](int k, float strength, const Vec3f& normal, const Vec3f& velocity) {
      const Vec3f u = v - velocity;
      give(k, [&] {
        return impulseAt(mass * strength * (u - dot(u, normal) * normal), p - drag.solids[k].pivot);
      });
    });
  }
};

WEIR_HD double square(const Vec3f& a) {
  return double(a.x) * a.x + double(a.y) * a.y + double(a.z) * a.z;
}

struct AddViscositySums {
  WEIR_HD ViscositySums operator()(const ViscositySums& a, const ViscositySums& b) const {
    return {a.residual + b.residual, a.change + b.change, a.speed + b.speed, a.curvature + b.curvature};
  }
};

struct SumAtFirst {
  ArrayView<const Vec3f> residual, change, velocities;
  WEIR_HD ViscositySums operator()(std::int64_t i) const {
    return {.residual = square(residual[i]), .change = square(change[i]), .speed = square(velocities[i])};
  }
};

struct SumCurvature {
  ArrayView<const Vec3f> direction, image;
  WEIR_HD ViscositySums operator()(std::int64_t i) const {
    const Vec3f p = direction[i], q = image[i];
    return {.curvature = double(p.x) * q.x + double(p.y) * q.y + double(p.z) * q.z};
  }
};

/// Goes along the direction, and sums what is left.
struct Advance {
  const ViscosityControl* control;
  ArrayView<const Vec3f> direction, image;
  ArrayView<Vec3f> change, residual;

  WEIR_HD ViscositySums operator()(std::int64_t i) const {
    if (control->done) return {};
    const Vec3f d = change[i] + control->alpha * direction[i], r = residual[i] - control->alpha * image[i];
    change[i] = d;
    residual[i] = r;
    return {.residual = square(r), .change = square(d)};
  }
};

/// The same for what is summed afterwards.
struct AdvanceAlone {
  Advance advance;
  WEIR_HD void operator()(std::int64_t i) const { advance(i); }
};

struct Turn {
  const ViscosityControl* control;
  ArrayView<const Vec3f> residual;
  ArrayView<Vec3f> direction;

  WEIR_HD void operator()(std::int64_t i) const {
    if (!control->done) direction[i] = residual[i] + control->beta * direction[i];
  }
};

/// The end of a step.
struct Apply {
  float dt;
  ArrayView<const Vec3f> change;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f d = change[i];
    velocities[i] += d;
    positions[i] += dt * d;
  }
};

struct DecideAtFirst {
  ViscosityControl* control;
  const ViscositySums* sums;
  double tolerance;

  WEIR_HD void operator()(std::int64_t) const {
    ViscosityControl& c = *control;
    c.residual = sums->residual;
    c.speed = sums->speed;
    c.iterations = 0;
    c.beta = 0;
    c.done = !(c.residual > tolerance * tolerance * sums->change) ? 1 : 0;
    ++c.steps;
  }
};

/// How far to go. A way that is lost in the rounding of velocities leads nowhere.
struct DecideWay {
  ViscosityControl* control;
  const ViscositySums* sums;

  WEIR_HD void operator()(std::int64_t) const {
    constexpr double kRounding = 6e-8;
    ViscosityControl& c = *control;
    if (c.done) return;
    const double alpha = c.residual / sums->curvature;
    c.alpha = static_cast<float>(alpha);
    if (!(alpha * alpha * c.residual > kRounding * kRounding * c.speed)) c.done = 1;
  }
};

struct Decide {
  ViscosityControl* control;
  const ViscositySums* sums;
  double tolerance;
  int last;  // the most iterations

  WEIR_HD void operator()(std::int64_t) const {
    ViscosityControl& c = *control;
    if (c.done) return;
    ++c.iterations;
    ++c.total;
    if (c.iterations > c.max) c.max = c.iterations;
    c.beta = static_cast<float>(sums->residual / c.residual);
    c.residual = sums->residual;
    const bool converged = !(c.residual > tolerance * tolerance * sums->change);
    if (converged || c.iterations >= last) c.done = 1;
    if (!converged && c.done) ++c.notConverged;
  }
};

constexpr float kDimensions = 3;

/// 2(d + 2)·F·V0.
double pairFactor(const FluidConstants& c) {
  return 2 * (kDimensions + 2) * viscosityFactor(c.supportRadius / c.spacing) * c.particleVolume;
}

/// That of the pairs, m^5.
float rateOf(const FluidStep& fluid, float viscosity) {
  const FluidConstants& c = fluid.constants;
  return static_cast<float>(pairFactor(c) * fluid.time.dt / c.restDensity) * viscosity;
}

/// For layers of which the first is `first` m from the plane.
PlaneDrag planeDragOf(const FluidStep& fluid, float viscosity) {
  constexpr float kNearest = 0.25f, kFirst = 0.5f;  // spacings
  const FluidConstants& c = fluid.constants;
  const double h = c.supportRadius, layers = layerFactor(h / c.spacing, kFirst);
  return {.radius = c.supportRadius,
          .nearest = kNearest * c.spacing,
          .rate = rateOf(fluid, viscosity) * static_cast<float>(layers / (pairFactor(c) * h * h)),
          .gap = gapFactor(h / c.spacing)};
}

DragOfSolid dragOfSolid(FluidStep& fluid, const PlaneDrag& plane) {
  const FluidConstants& c = fluid.constants;
  const WallField& walls = fluid.walls;
  return {.solids = walls.views.view(),
          .pairs = walls.pairs.view(),
          .plane = plane,
          .wallRadius = c.wallRadius,
          .wallFactor = c.wallFactor,
          .positions = fluid.particles.positions().read(),
          .each = walls.each.view()};
}

/// Sums what walls do.
template <class Backend>
void sumWalls(Backend& device, FluidStep& fluid, const PlaneDrag& plane, ArrayView<Vec4f> places,
              const WallDrag& walls) {
  if (!fluid.walls.boundary.empty())
    parallelFor(device, "wall drag", fluid.particles.count(),
                DragOfBoundary{fluid.walls.boundary.boundary, plane, places, walls});
  if (!fluid.walls.empty())
    parallelForUneven(device, "solid drag", fluid.walls.pairs.nearCount(),
                      DragOfSolids{dragOfSolid(fluid, plane), fluid.walls.pairs.near(), places, walls});
}

/// Gives solids the opposite of what they have done.
template <class Backend>
void pushSolids(Backend& device, FluidStep& fluid, const PlaneDrag& plane, ArrayView<const Vec3f> change) {
  WallField& walls = fluid.walls;
  sumByKeyOverRanks(device, "drag impulse", {ranksOf(fluid), walls.pairs.nearCount(), walls.pairs.bySolid()},
                    walls.views.size(),
                    DragImpulse{dragOfSolid(fluid, plane), walls.pairs.near(), fluid.constants.particleMass,
                                fluid.particles.velocities().read(), change},
                    AddImpulses{}, walls.impulses.data());
  giveImpulses(device, walls, 1);
}

}  // namespace

template <class Backend>
void ViscositySolver::stepOn(Backend& device, FluidStep& fluid) {
  fitScratch(fluid, residual_, direction_, image_);
  constexpr float kShortest = 0.1f;  // spacings
  const FluidConstants& c = fluid.constants;
  const Count count = fluid.particles.count();
  const float dt = static_cast<float>(fluid.time.dt);
  const Lease<Vec4f> placesRoom = fluid.particles.leasePlaces();
  const ArrayView<Vec4f> places = placesRoom.view();
  const ArrayView<Vec3f> change = change_.write();
  parallelFor(device, "begin", count,
              Begin{.dt = dt,
                    .positions = fluid.particles.positions().read(),
                    .velocities = fluid.particles.velocities().read(),
                    .change = change,
                    .places = places,
                    .start = direction_.view()});
  WallDrag walls;
  const PlaneDrag plane = planeDragOf(fluid, viscosity);
  if (!fluid.walls.boundary.empty() || !fluid.walls.empty()) {
    fitScratch(fluid, wallDiagonal_, wallRest_, wallPush_);
    wallDiagonal_.fillZero(), wallRest_.fillZero(), wallPush_.fillZero();
    walls = {wallDiagonal_.view(), wallRest_.view(), wallPush_.view()};
    sumWalls(device, fluid, plane, places, walls);
  }
  fluid.exchange(places);
  fluid.exchange(direction_.view());
  const PairDrag drag{fluid.neighbors.view(), SpikyKernel(c.supportRadius, 1), rateOf(fluid, viscosity),
                      kShortest * c.spacing, places};
  solveOn(device, fluid, drag, walls, change);
  if (!walls.empty() && !fluid.walls.empty()) pushSolids(device, fluid, plane, change);
  parallelFor(device, "apply", count,
              Apply{dt, change, fluid.particles.positions().write(), fluid.particles.velocities().write()});
}

template <class Backend, class Drag>
void ViscositySolver::solveOn(Backend& device, FluidStep& fluid, const Drag& drag, const WallDrag& walls,
                              ArrayView<Vec3f> change) {
  const Count count = fluid.particles.count();
  const ArrayView<Vec3f> residual = residual_.view(), direction = direction_.view(), image = image_.view();
  ViscosityControl* const control = control_->data();
  ViscositySums* const sums = sums_.data();
  const bool mayTeam = fluid.divided == nullptr;
  const auto sum = [&](std::string_view name, const auto& of) {
    sumOverRanks(device, name, allOf(fluid), of, AddViscositySums{}, sums);
  };
  const SumAtFirst left{residual, change, fluid.particles.velocities().read()};
  parallelForSums(device, "residual", count, FirstResidual{drag, walls, direction, change, residual},
                  mayTeam);
  sum("measure", left);
  parallelFor(device, "decide", 1, DecideAtFirst{control, sums, tolerance});
  ++steps_;
  controlSeen_->request(control);
  for (int k = 0; k < maxIterations && !isDone(fluid); ++k) {
    parallelFor(device, "turn", count, Turn{control, residual, direction});
    fluid.exchange(direction);
    parallelForSums(device, "image", count, Image{drag, walls, control, direction, image}, mayTeam);
    sum("curvature", SumCurvature{direction, image});
    parallelFor(device, "decide", 1, DecideWay{control, sums});
    const Advance advance{control, direction, image, change, residual};
    if (fluid.divided == nullptr) {
      sum("advance", advance);
    } else {
      parallelFor(device, "advance", count, AdvanceAlone{advance});
      sum("measure", left);
    }
    parallelFor(device, "decide", 1, Decide{control, sums, tolerance, maxIterations});
    controlSeen_->request(control);
  }
}

template void ViscositySolver::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
