#include "dfsph.h"

#include <algorithm>

#include <weir/density.h>

namespace dfsph {

namespace {

constexpr float kRelaxation = 0.5f;   // ω
constexpr float kSoftening = 1e-2f;   // added to D, per spacing²: for particles with hardly a neighbour
constexpr float kShortest = 1e-6f;    // spacings; keeps pairs in one place from dividing by 0
constexpr float kFullDensity = 0.9f;  // fluid below is at a surface, where convergence fills no gap

/// g_ij for d = x_i − x_j, or eight of them.
struct PairGradient {
  SpikyKernel kernel;
  float particleVolume, shortest;

  template <class T>
  WEIR_HD Vec3<T> operator()(const Vec3<T>& d) const {
    const T r = sqrtf(dot(d, d)) + shortest;
    const T factor = -particleVolume * kernel.slope(r) / r;
    return {factor * d.x, factor * d.y, factor * d.z};
  }
};

/// Positions, and the pressures that the iterations begin with; 0 where none are given.
struct Begin {
  float restDensity;
  ArrayView<const Vec3f> positions;
  ArrayView<const float> pressure;
  ArrayView<Vec4f> state;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    state[i] = {p.x, p.y, p.z, pressure.size > 0 ? pressure[i] / restDensity : 0.0f};
  }
};

/// λ − 1 and D.
struct FindDiagonal {
  NeighborView neighbors;
  PairGradient gradient;
  float softening;
  WallFieldView walls;
  ArrayView<const Vec4f> state;
  ArrayView<float> over, diagonal;  // λ − 1, D

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec4f s = state[i];
    const auto squares = [&]<class T>(const auto&, const Vec4<T>& t) {
      const Vec3<T> g = gradient(Vec3<T>{s.x - t.x, s.y - t.y, s.z - t.z});
      return Vec4<T>{g.x, g.y, g.z, dot(g, g)};
    };
    const Vec4f sum = sumOverNeighbors<Vec4f>(i, neighbors, squares, state);
    float lambda = relativeDensity(i, neighbors, gradient.kernel, gradient.particleVolume, state);
    const Vec3f fluid = xyz(sum);
    float d = sum.w + dot(fluid, fluid);
    if (!walls.empty()) {
      const Vec3f wall = walls.push(i, xyz(s)).gradPhi;
      lambda += walls.phi(i, xyz(s));
      const float both = dot(fluid + wall, fluid + 2 * wall);
      d = sum.w + (both > 0 ? both : 0.0f);
    }
    over[i] = lambda - 1;
    diagonal[i] = d + softening;
  }
};

/// dt·Dλ/Dt, in place of λ − 1. Particles at a surface are left alone.
struct FindGrowth {
  NeighborView neighbors;
  PairGradient gradient;
  float dt;
  BoundaryIntegrals boundary;
  ArrayView<const SolidView> solids;
  SolidPairsView pairs;
  ArrayView<const Vec4f> each;  // of pairs
  ArrayView<const Vec4f> state;
  ArrayView<const Vec3f> velocities;
  ArrayView<float> source;

  WEIR_HD void operator()(std::int64_t i) const {
    if (source[i] + 1 < kFullDensity) {
      source[i] = -1;
      return;
    }
    const Vec4f s = state[i];
    const Vec3f v = velocities[i];
    const auto rate = [&]<class T>(const auto&, const Vec4<T>& t, const Vec3<T>& w) {
      const Vec3<T> g = gradient(Vec3<T>{s.x - t.x, s.y - t.y, s.z - t.z});
      return g.x * (v.x - w.x) + g.y * (v.y - w.y) + g.z * (v.z - w.z);
    };
    float sum = sumOverNeighbors<float>(i, neighbors, rate, state, velocities);
    if (!boundary.empty()) sum += dot(boundary.at(xyz(s)).gradPhi, v);
    if (solids.size > 0)
      for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair)
        sum += dot(xyz(each[pair]), v - solids[pairs.solid[pair]].velocityAt(xyz(s)));
    source[i] = dt * sum;
  }
};

/// u of the present pressures.
struct Displace {
  NeighborView neighbors;
  PairGradient gradient;
  float dtSquared;
  WallFieldView walls;
  ArrayView<const Vec4f> state;
  ArrayView<Vec3f> displacement;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec4f s = state[i];
    const auto push = [&]<class T>(const auto&, const Vec4<T>& t) {
      const Vec3<T> g = gradient(Vec3<T>{s.x - t.x, s.y - t.y, s.z - t.z});
      const T p = s.w + t.w;
      return Vec4<T>{p * g.x, p * g.y, p * g.z, p};
    };
    Vec3f sum = xyz(sumOverNeighbors<Vec4f>(i, neighbors, push, state));
    if (!walls.empty()) sum += 2 * s.w * walls.push(i, xyz(s)).gradPhi;
    displacement[i] = -dtSquared * sum;
  }
};

/// What is left of the error, and the pressures of the next iteration.
struct Improve {
  NeighborView neighbors;
  PairGradient gradient;
  float dtSquared;
  WallFieldView walls;
  ArrayView<const float> source, diagonal;
  ArrayView<const Vec3f> displacement;
  ArrayView<const Vec4f> state;
  ArrayView<Vec4f> next;
  ArrayView<float> error;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec4f s = state[i];
    const Vec3f u = displacement[i];
    const auto growth = [&]<class T>(const auto&, const Vec4<T>& t, const Vec3<T>& w) {
      const Vec3<T> g = gradient(Vec3<T>{s.x - t.x, s.y - t.y, s.z - t.z});
      return g.x * (u.x - w.x) + g.y * (u.y - w.y) + g.z * (u.z - w.z);
    };
    float left = source[i] + sumOverNeighbors<float>(i, neighbors, growth, state, displacement);
    if (!walls.empty()) left += dot(walls.push(i, xyz(s)).gradPhi, u);
    const float p = s.w + kRelaxation * left / (dtSquared * diagonal[i]);
    next[i] = {s.x, s.y, s.z, p > 0 ? p : 0.0f};
    error[i] = left > 0 ? left : 0.0f;
  }
};

struct ValueOf {
  ArrayView<const float> values;
  WEIR_HD float operator()(std::int64_t i) const { return values[i]; }
};

struct Add {
  WEIR_HD float operator()(float a, float b) const { return a + b; }
};

/// v = v + u/dt, and x = x + u if positions are given.
struct Finish {
  float dt, restDensity;
  WallFieldView walls;
  ArrayView<const Vec4f> state;
  ArrayView<const Vec3f> displacement;
  ArrayView<Vec3f> positions, velocities;
  ArrayView<float> pressure;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f u = displacement[i];
    velocities[i] += u / dt;
    if (walls.share.size > 0) walls.share[i] -= 2 * dt * dt * state[i].w;
    if (positions.size == 0) return;
    positions[i] += u;
    pressure[i] = restDensity * state[i].w;
  }
};

PairGradient gradientOf(const FluidConstants& c) {
  return {c.kernel, c.particleVolume, kShortest * c.spacing};
}

}  // namespace

template <class Backend>
void Dfsph::solve(Backend& device, FluidStep& fluid, float until, SolverRecord& record) {
  const FluidConstants& c = fluid.constants;
  const Count count = fluid.particles.count();
  const NeighborView neighbors = fluid.neighbors.view();
  const PairGradient gradient = gradientOf(c);
  const WallFieldView walls = fluid.walls.view();
  const float dt = static_cast<float>(fluid.time.dt);
  int iterations = 0;
  double error = 0;
  for (;;) {
    parallelFor(device, "displace", count,
                Displace{neighbors, gradient, dt * dt, walls, state_.view(), displacement_.view()});
    parallelFor(device, "improve", count,
                Improve{neighbors, gradient, dt * dt, walls, source_.view(), diagonal_.view(),
                        displacement_.view(), state_.view(), next_.view(), error_.view()});
    reduce(device, "error", count, 0.0f, ValueOf{error_.view()}, Add{}, errorSum_.data());
    error = double(errorSum_.toHost().front()) / double(std::max<std::int64_t>(count.bound, 1));
    ++iterations;
    if (error <= until || iterations >= maxIterations) break;
    state_.swap(next_);
  }
  record.iterations += iterations;
  ++record.steps;
  record.error = error;
  record.maxError = std::max(record.maxError, error);
  if (!(error <= until)) ++record.unfinished;
}

template <class Backend>
void Dfsph::stepOn(Backend& device, FluidStep& fluid) {
  fit(fluid);
  const FluidConstants& c = fluid.constants;
  ParticleSet& particles = fluid.particles;
  const Count count = particles.count();
  const NeighborView neighbors = fluid.neighbors.view();
  const WallFieldView walls = fluid.walls.view();
  const float dt = static_cast<float>(fluid.time.dt);
  const float softening = kSoftening / (c.spacing * c.spacing);
  const ArrayView<Vec3f> positions = particles.positions().write(),
                         velocities = particles.velocities().write();
  const auto begin = [&](ArrayView<const float> pressure) {
    parallelFor(device, "begin", count, Begin{c.restDensity, positions, pressure, state_.view()});
    parallelFor(device, "diagonal", count,
                FindDiagonal{neighbors, gradientOf(c), softening, walls, state_.view(), source_.view(),
                             diagonal_.view()});
  };
  const auto finish = [&](ArrayView<Vec3f> moved) {
    parallelFor(device, "finish", count,
                Finish{dt, c.restDensity, walls, state_.view(), displacement_.view(), moved, velocities,
                       pressure_.write()});
  };

  fluid.walls.forgetShares();
  begin(pressure_.read());
  solve(device, fluid, tolerance, density_);
  finish(positions);
  if (!divergenceFree) return;

  begin({});
  const bool meets = !fluid.walls.empty();
  parallelFor(device, "growth", count,
              FindGrowth{neighbors, gradientOf(c), dt, fluid.walls.boundary,
                         meets ? std::as_const(fluid.walls.views).view() : ArrayView<const SolidView>{},
                         fluid.walls.pairs.view(), std::as_const(fluid.walls.each).view(), state_.view(),
                         velocities, source_.view()});
  solve(device, fluid, divergenceTolerance, divergence_);
  finish({});
}

template void Dfsph::stepOn(ThisBackend&, FluidStep&);

}  // namespace dfsph
