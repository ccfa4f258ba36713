#include "nodes/particle_fluid/modules/viscosity_solver.h"

#include "framework/compute/reductions.h"
#include "framework/neighbors/neighbor_sum.h"
#include "nodes/particle_fluid/displacement.h"
#include "nodes/particle_fluid/scratch.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

namespace {

/// Where particles were at the beginning of the step, with their share in the drag of pairs; and velocities
/// to start from.
struct Begin {
  float dt, rate;
  ArrayView<const Vec3f> positions, velocities, change;
  ArrayView<Vec4f> places;
  ArrayView<Vec3f> start;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f v = velocities[i], x = positions[i] - dt * v;
    places[i] = {x.x, x.y, x.z, rate};
    start[i] = v + change[i];
  }
};

/// K·u.
struct PairDrag {
  NeighborView neighbors;
  SpikyKernel kernel;
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
      // The harmonic mean, without a division by 0 where both are 0.
      const T sum = place.w + q.w;
      const T mean = zeroUnless(sum > T(0), fastDivide(2.0f * place.w * q.w, sum));
      const T along = dot(d, Vec3<T>{own.x - other.x, own.y - other.y, own.z - other.z});
      const T c = fastDivide(mean * kernel.slope(near), r * r * r) * along;
      return Vec4<T>{c * d.x, c * d.y, c * d.z, c};
    };
    return xyz(sumOverNeighbors<Vec4f>(i, neighbors, drag, places, u));
  }
};

/// v* − (1 + K)·v of the velocities to start from.
struct FirstResidual {
  PairDrag drag;
  ArrayView<const Vec3f> start, change;
  ArrayView<Vec3f> residual;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    write(residual, i, -(drag(i, start) + read(change, i)));
  }
};

/// The direction's image, (1 + K)·p.
struct Image {
  PairDrag drag;
  const ViscosityControl* control;
  ArrayView<const Vec3f> direction;
  ArrayView<Vec3f> image;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    if (control->done) return;
    write(image, i, drag(i, direction) + read(direction, i));
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

}  // namespace

template <class Backend>
void ViscositySolver::stepOn(Backend& device, FluidStep& fluid) {
  fitScratch(fluid, residual_, direction_, image_);
  constexpr float kShortest = 0.1f;  // spacings
  constexpr float kDimensions = 3;
  const FluidConstants& c = fluid.constants;
  const Count count = fluid.particles.count();
  const float dt = static_cast<float>(fluid.time.dt);
  const float perViscosity =
      static_cast<float>(2 * (kDimensions + 2) * viscosityFactor(c.supportRadius / c.spacing) * dt *
                         c.particleVolume / c.restDensity);
  const Lease<Vec4f> placesRoom = fluid.particles.leasePlaces();
  const ArrayView<Vec4f> places = placesRoom.view();
  const ArrayView<Vec3f> change = change_.write(), residual = residual_.view(), direction = direction_.view(),
                         image = image_.view();
  const ArrayView<const Vec3f> velocities = fluid.particles.velocities().read();
  ViscosityControl* const control = control_->data();
  ViscositySums* const sums = sums_.data();
  const PairDrag drag{fluid.neighbors.view(), SpikyKernel(c.supportRadius, 1), kShortest * c.spacing, places};

  parallelFor(device, "begin", count,
              Begin{.dt = dt,
                    .rate = perViscosity * viscosity,
                    .positions = fluid.particles.positions().read(),
                    .velocities = velocities,
                    .change = change,
                    .places = places,
                    .start = direction});
  parallelForSums(device, "residual", count, FirstResidual{drag, direction, change, residual});
  reduce(device, "measure", count, ViscositySums{}, SumAtFirst{residual, change, velocities},
         AddViscositySums{}, sums);
  parallelFor(device, "decide", 1, DecideAtFirst{control, sums, tolerance});
  ++steps_;
  controlSeen_->request(control);
  for (int k = 0; k < maxIterations && !isDone(); ++k) {
    parallelFor(device, "turn", count, Turn{control, residual, direction});
    parallelForSums(device, "image", count, Image{drag, control, direction, image});
    reduce(device, "curvature", count, ViscositySums{}, SumCurvature{direction, image}, AddViscositySums{},
           sums);
    parallelFor(device, "decide", 1, DecideWay{control, sums});
    reduce(device, "advance", count, ViscositySums{}, Advance{control, direction, image, change, residual},
           AddViscositySums{}, sums);
    parallelFor(device, "decide", 1, Decide{control, sums, tolerance, maxIterations});
    controlSeen_->request(control);
  }
  parallelFor(device, "apply", count,
              Apply{dt, change, fluid.particles.positions().write(), fluid.particles.velocities().write()});
}

template void ViscositySolver::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
