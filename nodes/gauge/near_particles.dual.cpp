#include "nodes/gauge/near_particles.h"

#include "framework/compute/parallel.h"

namespace weir {

namespace {

struct IsNear {
  Vec3f a, toB;
  float inverseSquare, reachSquared;  // of toB's length; 0 if it has none
  ArrayView<const Vec3f> positions;

  WEIR_HD bool operator()(std::int64_t i) const {
    const Vec3f fromA = positions[i] - a;
    const float along = dot(fromA, toB) * inverseSquare;
    const Vec3f away = fromA - (along < 0 ? 0.0f : along > 1 ? 1.0f : along) * toB;
    return dot(away, away) <= reachSquared;
  }
};

struct Gather {
  MatterView matter;
  ArrayView<const int> indices;
  ArrayView<ParticleMatter> to;
  WEIR_HD void operator()(std::int64_t k) const { to[k] = matter[indices[k]]; }
};

}  // namespace

template <class Backend>
void findNear(Backend& device, const Particles& particles, const Vec3f& a, const Vec3f& b, float reach,
              ArrayView<int> indices, int* found) {
  const ParticleSet& set = particles.set();
  const Vec3f toB = b - a;
  const float square = dot(toB, toB);
  compact(device, "find near", set.count(),
          IsNear{a, toB, square > 0 ? 1 / square : 0.0f, reach * reach, set.positions().read()}, indices,
          found);
}

template <class Backend>
void gather(Backend& device, const MatterView& matter, ArrayView<const int> indices,
            ArrayView<ParticleMatter> to) {
  parallelFor(device, "gather", indices.size, Gather{matter, indices, to});
}

template void findNear(ThisBackend&, const Particles&, const Vec3f&, const Vec3f&, float, ArrayView<int>,
                       int*);
template void gather(ThisBackend&, const MatterView&, ArrayView<const int>, ArrayView<ParticleMatter>);

}  // namespace weir
