#include "nodes/particle_fluid/rest_state.h"

#include "framework/compute/parallel.h"
#include "framework/compute/reductions.h"
#include "framework/particles/divided_particles.h"
#include "nodes/particle_fluid/wall_field.h"
#include "nodes/static_boundary/boundary.h"

namespace weir {

namespace {

/// A batch's particles, by their ids.
struct Batch {
  std::int64_t firstId;
  std::int64_t size;
  ArrayView<const std::int64_t> ids;

  /// Below 0 or beyond the size for particles of other batches.
  WEIR_HD std::int64_t indexOf(std::int64_t i) const { return ids[i] - firstId; }
  WEIR_HD bool has(std::int64_t i) const { return indexOf(i) >= 0 && indexOf(i) < size; }
};

struct Damp {
  Batch batch;
  float kept;
  Vec3f lift;  // m/s, against the gravity of the step
  ArrayView<Vec3f> velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    if (batch.has(i)) velocities[i] = kept * velocities[i] + lift;
  }
};

/// A batch's container, where no wall does its part: what a wall holds lies where the wall's pressure puts
/// it.
struct Container {
  BoundaryView region;
  float contact;  // m, distance that particles keep from it; half as much from its top, where fluid is free
  Vec3f up;       // unit, or 0 without gravity
  WallFieldView walls;

  struct Hit {
    float inside;  // m, how far the particle is to be moved
    Vec3f normal;
  };
  WEIR_HD Hit of(std::int64_t i, const Vec3f& p) const {
    const BoundaryHit hit = boundaryQuery(region, p);
    const float kept = isTop(hit.normal) ? 0.5f * contact : contact;
    if (!(hit.distance < kept)) return {0, hit.normal};
    const Vec3f wall = walls.empty() ? Vec3f{} : walls.sharedGradient(i, p);
    constexpr float kAlong = 0.5f;  // cosine; in a corner of three walls that of their mean is 0.58
    const bool walled = -dot(wall, hit.normal) > kAlong * length(wall);
    return {walled ? 0 : kept - hit.distance, hit.normal};
  }
  WEIR_HD bool isTop(const Vec3f& normal) const {
    constexpr float kDown = -0.5f;  // cosine
    return dot(normal, up) < kDown;
  }
};

struct Contain {
  Batch batch;
  Container container;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    if (!batch.has(i)) return;
    constexpr int kMaxContacts = 4;
    for (int k = 0; k < kMaxContacts; ++k) {
      const Container::Hit hit = container.of(i, positions[i]);
      if (!(hit.inside > 0)) return;
      positions[i] += hit.inside * hit.normal;
      const float speed = dot(velocities[i], hit.normal);
      if (speed < 0) velocities[i] -= speed * hit.normal;
    }
  }
};

/// By how much a container is to move each particle, m, other than down: a region's top carries nothing.
struct Push {
  Batch batch;
  Container container;
  ArrayView<const Vec3f> positions;

  WEIR_HD ExactSum operator()(std::int64_t i) const {
    if (!batch.has(i)) return ExactSum();
    const Container::Hit hit = container.of(i, positions[i]);
    return ExactSum(container.isTop(hit.normal) ? 0 : hit.inside);
  }
};

struct Hold {
  Batch batch;
  ArrayView<const Vec3f> initial;  // of the batch, or of all particles
  bool isOfAll;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    if (!batch.has(i)) return;
    positions[i] = initial[isOfAll ? i : batch.indexOf(i)];
    velocities[i] = {};
  }
};

struct Release {
  Batch batch;
  ParticleBatch::VelocityView initial;
  ArrayView<Vec3f> velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    if (batch.has(i)) velocities[i] = initial[batch.indexOf(i)];
  }
};

template <class T>
struct GiveBack {
  Batch batch;
  ArrayView<const T> initial;
  ArrayView<T> values;

  WEIR_HD void operator()(std::int64_t i) const {
    if (batch.has(i)) values[i] = initial[batch.indexOf(i)];
  }
};

struct SquareSpeed {
  ArrayView<const Vec3f> velocities;
  WEIR_HD ExactSum operator()(std::int64_t i) const { return ExactSum(dot(velocities[i], velocities[i])); }
};

/// Calls f(of, its ids) for all batches.
template <class Resting, class F>
void forEachBatch(std::vector<Resting>& batches, const ParticleSet& particles, const F& f) {
  std::int64_t first = 0;
  for (Resting& of : batches) {
    if (of.count > 0) f(of, Batch{first, of.count, particles.ids().read()});
    first += of.count;
  }
}

/// Calls f(name, values) for what particles of a batch bring with them.
template <class F>
void forEachBrought(const ParticleBatch& batch, const F& f) {
  for (const BatchAttribute& brought : batch.attributes)
    std::visit([&](const auto& values) { f(brought.info.name, values); }, brought.values);
}

template <class Resting>
Container containerOf(const Resting& of, FluidStep& fluid) {
  const float pull = length(fluid.time.gravity);
  return {.region = of.batch->container->view(),
          .contact = of.batch->contact,
          .up = pull > 0 ? fluid.time.gravity / -pull : Vec3f{},
          .walls = fluid.walls.view()};
}

}  // namespace

template <class Backend>
void RestState::dampOn(Backend& device, float kept) {
  ParticleSet& p = fluid_.particles;
  const Vec3f lift = -static_cast<float>(fluid_.time.dt) * fluid_.time.gravity;
  forEachBatch(batches_, p, [&](const Resting& of, const Batch& batch) {
    if (of.batch->container)
      parallelFor(device, "damp", p.count(),
                  Damp{batch, kept, of.weightless ? lift : Vec3f{}, p.velocities().write()});
  });
}

template <class Backend>
void RestState::findCarriedOn(Backend& device) {
  ParticleSet& p = fluid_.particles;
  const double fall = length(fluid_.time.gravity) * fluid_.time.dt * fluid_.time.dt;
  forEachBatch(batches_, p, [&](Resting& of, const Batch& batch) {
    if (!of.batch->container || !of.undecided() || !(fall > 0)) return;
    reduce(device, "carried", p.count(), ExactSum(),
           Push{batch, containerOf(of, fluid_), p.positions().read()}, Plus{}, sum_.data());
    of.carried += sumOfAll() / (fall * static_cast<double>(batch.size));
  });
}

template <class Backend>
void RestState::containOn(Backend& device) {
  ParticleSet& p = fluid_.particles;
  forEachBatch(batches_, p, [&](const Resting& of, const Batch& batch) {
    if (of.batch->container)
      parallelFor(device, "contain", p.count(),
                  Contain{batch, containerOf(of, fluid_), p.positions().write(), p.velocities().write()});
    else
      parallelFor(device, "hold", p.count(),
                  Hold{batch, holdsParts_ ? places_.read().view() : of.batch->positions.view(), holdsParts_,
                       p.positions().write(), p.velocities().write()});
  });
}

template <class Backend>
void RestState::releaseOn(Backend& device) {
  ParticleSet& p = fluid_.particles;
  forEachBatch(batches_, p, [&](const Resting& of, const Batch& batch) {
    parallelFor(device, "release", p.count(),
                Release{batch, of.batch->velocityView(), p.velocities().write()});
  });
}

template <class Backend>
void RestState::giveBackOn(Backend& device) {
  ParticleSet& p = fluid_.particles;
  forEachBatch(batches_, p, [&](const Resting& of, const Batch&) {
    forEachBrought(*of.batch,
                   [&]<class T>(const std::string& name, const Array<T>&) { p.get<T>(name).fillZero(); });
  });
  forEachBatch(batches_, p, [&](const Resting& of, const Batch& batch) {
    forEachBrought(*of.batch, [&]<class T>(const std::string& name, const Array<T>& initial) {
      parallelFor(device, "give back", p.count(), GiveBack<T>{batch, initial.view(), p.get<T>(name).write()});
    });
  });
}

template <class Backend>
double RestState::meanSquareSpeedOn(Backend& device) {
  ParticleSet& p = fluid_.particles;
  reduce(device, "speed", p.count(), ExactSum(), SquareSpeed{p.velocities().read()}, Plus{}, sum_.data());
  const std::int64_t count = fluid_.divided != nullptr ? fluid_.divided->countOfAll() : p.refreshCount();
  return count > 0 ? sumOfAll() / static_cast<double>(count) : 0;
}

template void RestState::dampOn(ThisBackend&, float);
template void RestState::findCarriedOn(ThisBackend&);
template void RestState::containOn(ThisBackend&);
template void RestState::releaseOn(ThisBackend&);
template void RestState::giveBackOn(ThisBackend&);
template double RestState::meanSquareSpeedOn(ThisBackend&);

}  // namespace weir
