#include "nodes/particle_fluid/rest_state.h"

#include "framework/compute/parallel.h"
#include "nodes/static_boundary/boundary.h"

namespace weir {

namespace {

/// A batch's particles, by their ids.
struct Batch {
  int firstId;
  std::int64_t size;
  ArrayView<const int> ids;

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

struct Contain {
  Batch batch;
  BoundaryView container;
  float contact;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    if (!batch.has(i)) return;
    constexpr int kMostContacts = 4;
    for (int k = 0; k < kMostContacts; ++k) {
      const BoundaryHit hit = boundaryQuery(container, positions[i]);
      if (!(hit.distance < contact)) return;
      positions[i] += (contact - hit.distance) * hit.normal;
      const float speed = dot(velocities[i], hit.normal);
      if (speed < 0) velocities[i] -= speed * hit.normal;
    }
  }
};

struct Hold {
  Batch batch;
  ArrayView<const Vec3f> initial;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    if (!batch.has(i)) return;
    positions[i] = initial[batch.indexOf(i)];
    velocities[i] = {};
  }
};

struct Release {
  Batch batch;
  ArrayView<const Vec3f> initial;
  ArrayView<Vec3f> velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    if (batch.has(i)) velocities[i] = initial[batch.indexOf(i)];
  }
};

struct SquareSpeed {
  ArrayView<const Vec3f> velocities;
  WEIR_HD double operator()(std::int64_t i) const { return dot(velocities[i], velocities[i]); }
};

struct Plus {
  WEIR_HD double operator()(double a, double b) const { return a + b; }
};

/// Calls f(batch, its ids) for all batches.
template <class F>
void forEachBatch(const std::vector<const ParticleBatch*>& batches, const ParticleSet& particles,
                  const F& f) {
  std::int64_t first = 0;
  for (const ParticleBatch* batch : batches) {
    if (batch->count > 0) f(*batch, Batch{static_cast<int>(first), batch->count, particles.ids().view()});
    first += batch->count;
  }
}

}  // namespace

template <class Backend>
void RestState::dampOn(Backend& device, float kept) {
  ParticleSet& p = fluid_.particles;
  const Vec3f lift = -static_cast<float>(fluid_.time.dt) * fluid_.time.gravity;
  forEachBatch(batches_, p, [&](const ParticleBatch& from, const Batch& batch) {
    if (from.container)
      parallelFor(device, "damp", p.count(),
                  Damp{batch, kept, from.weightless ? lift : Vec3f{}, p.velocities().view()});
  });
}

template <class Backend>
void RestState::containOn(Backend& device) {
  ParticleSet& p = fluid_.particles;
  forEachBatch(batches_, p, [&](const ParticleBatch& from, const Batch& batch) {
    if (from.container)
      parallelFor(
          device, "contain", p.count(),
          Contain{batch, from.container->view(), from.contact, p.positions().view(), p.velocities().view()});
    else
      parallelFor(device, "hold", p.count(),
                  Hold{batch, from.positions.view(), p.positions().view(), p.velocities().view()});
  });
}

template <class Backend>
void RestState::releaseOn(Backend& device) {
  ParticleSet& p = fluid_.particles;
  forEachBatch(batches_, p, [&](const ParticleBatch& from, const Batch& batch) {
    parallelFor(device, "release", p.count(), Release{batch, from.velocities.view(), p.velocities().view()});
  });
}

template <class Backend>
double RestState::meanSquareSpeedOn(Backend& device) {
  ParticleSet& p = fluid_.particles;
  reduce(device, "speed", p.count(), 0.0, SquareSpeed{p.velocities().view()}, Plus{}, sum_.data());
  const std::int64_t count = p.refreshCount();
  return count > 0 ? sum_.toHost().front() / static_cast<double>(count) : 0;
}

template void RestState::dampOn(ThisBackend&, float);
template void RestState::containOn(ThisBackend&);
template void RestState::releaseOn(ThisBackend&);
template double RestState::meanSquareSpeedOn(ThisBackend&);

}  // namespace weir
