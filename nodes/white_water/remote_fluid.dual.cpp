#include "nodes/white_water/remote_fluid.h"

#include "framework/compute/parallel.h"

namespace weir {

namespace {

struct IsWanted {
  CellLayers layers;
  int first, last;
  ArrayView<const Vec3f> positions, velocities;

  WEIR_HD bool operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    if (!isFinite(p) || !isFinite(velocities[i])) return false;
    const int layer = layers.layerOf(p);
    return layer >= first && layer <= last;
  }
};

struct PackPoint {
  ArrayView<const int> indices;
  ArrayView<const Vec3f> positions, velocities;
  ArrayView<const float> volumes;  // empty where all have the same
  float volume;
  ArrayView<const std::int64_t> ids;
  ArrayView<FluidPoint> to;

  WEIR_HD void operator()(std::int64_t k) const {
    const int i = indices[k];
    const Vec3f p = positions[i];
    to[k] = {{p.x, p.y, p.z, volumes.size > 0 ? volumes[i] : volume}, velocities[i], ids[i]};
  }
};

}  // namespace

template <class Backend>
std::int64_t RemoteFluid::findWantedOn(Backend& device, const Particles& own, const CellLayers& layers,
                                       const Layers& wanted) {
  const ParticleSet& set = own.set();
  found_.resizeDiscarding(set.bound());
  compact(device, "wanted", set.count(),
          IsWanted{layers, wanted.first, wanted.last, set.positions().read(), set.velocities().read()},
          found_.view(), foundCount_.data());
  return foundCount_.toHost().front();
}

template <class Backend>
void RemoteFluid::packOn(Backend& device, const Particles& own, ArrayView<FluidPoint> to) {
  const ParticleSet& set = own.set();
  const Attribute<const float> volumes = own.ownValues(own.material.volume);
  parallelFor(device, "pack points", to.size,
              PackPoint{std::as_const(found_).view(), set.positions().read(), set.velocities().read(),
                        volumes ? volumes.read().view() : ArrayView<const float>{}, own.material.volume.value,
                        set.ids().read(), to});
}

template std::int64_t RemoteFluid::findWantedOn(ThisBackend&, const Particles&, const CellLayers&,
                                                const Layers&);
template void RemoteFluid::packOn(ThisBackend&, const Particles&, ArrayView<FluidPoint>);

}  // namespace weir
