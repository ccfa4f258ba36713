// Which particles of a set others own, and where those of others stand.
#include "framework/particles/divided_particles.h"

#include "framework/compute/parallel.h"

namespace weir {

namespace {

/// Who owns a particle; whoever has it, if it is not finite.
struct OwnerOf {
  SlabsView slabs;
  int self;
  ArrayView<const Vec3f> positions;

  WEIR_HD int operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    return isFinite(p) ? slabs.slabOf(p) : self;
  }
};

struct Leaves {
  OwnerOf ownerOf;
  WEIR_HD bool operator()(std::int64_t i) const { return ownerOf(i) != ownerOf.self; }
};

/// Of those that every rank has, the k-th or, where some are selected, order[k]; what is not finite belongs
/// to rank 0.
struct IsOwn {
  SlabsView slabs;
  int self;
  ArrayView<const Vec3f> positions;
  ArrayView<const int> order;  // empty for all

  WEIR_HD bool operator()(std::int64_t k) const {
    const Vec3f p = positions[order.size > 0 ? order[k] : k];
    return (isFinite(p) ? slabs.slabOf(p) : 0) == self;
  }
};

struct FollowOrder {
  ArrayView<const int> order;
  ArrayView<int> indices;
  WEIR_HD void operator()(std::int64_t k) const { indices[k] = order[indices[k]]; }
};

struct WriteOwner {
  OwnerOf ownerOf;
  ArrayView<const int> indices;
  ArrayView<int> owners;
  WEIR_HD void operator()(std::int64_t k) const { owners[k] = ownerOf(indices[k]); }
};

struct CountInLayers {
  CellLayers layers;
  ArrayView<const Vec3f> positions;
  ArrayView<int> counts;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    if (isFinite(p)) atomicAdd(&counts[layers.layerOf(p) - layers.first], 1);
  }
};

/// Where the cells of a layer start, from where they started on another rank; all at one place if nobody is
/// there.
struct PlaceLayer {
  ArrayView<const int> theirs;  // empty for none
  int first;                    // where the layer starts here
  int* start;

  WEIR_HD void operator()(std::int64_t c) const {
    start[c] = first + (theirs.size > 0 ? theirs[c] - theirs[0] : 0);
  }
};

}  // namespace

template <class Backend>
std::int64_t DividedParticles::findLeavingOn(Backend& device, ArrayView<const Vec3f> points) {
  const Count count = particles_.count();
  found_.resizeDiscarding(count.bound);
  compact(device, "leave", count, Leaves{{onDevice(), ranks_.rank(), points}}, found_.view(),
          foundCount_.data());
  return foundCount_.toHost().front();
}

template <class Backend>
void DividedParticles::findOwnersOn(Backend& device, ArrayView<const Vec3f> points,
                                    ArrayView<const int> indices) {
  owners_.resizeDiscarding(indices.size);
  parallelFor(device, "owners", indices.size,
              WriteOwner{{onDevice(), ranks_.rank(), points}, indices, owners_.view()});
}

template <class Backend>
std::int64_t DividedParticles::findOwnOn(Backend& device, ArrayView<const Vec3f> positions,
                                         const BatchSelection& selected, ArrayView<int> own) {
  compact(device, "own", Count{positions.size, selected.kept},
          IsOwn{onDevice(), ranks_.rank(), positions, selected.order}, own, foundCount_.data());
  const std::int64_t count = foundCount_.toHost().front();
  if (selected.order.size > 0)
    parallelFor(device, "own", count, FollowOrder{selected.order, {own.data, count}});
  return count;
}

template <class Backend>
void DividedParticles::countInLayersOn(Backend& device, ArrayView<const Vec3f> positions, const Count& count,
                                       ArrayView<int> counts) {
  parallelFor(device, "count in layers", count, CountInLayers{slabs_.layers, positions, counts});
}

template <class Backend>
void DividedParticles::placeLayerOn(Backend& device, const SortedLayers& sorted, int layer,
                                    ArrayView<const int> start, std::int64_t first) {
  parallelFor(device, "place layer", sorted.cellsInLayer + 1,
              PlaceLayer{start, static_cast<int>(first),
                         sorted.cellStart.data + std::int64_t{layer} * sorted.cellsInLayer});
}

template std::int64_t DividedParticles::findLeavingOn(ThisBackend&, ArrayView<const Vec3f>);
template void DividedParticles::findOwnersOn(ThisBackend&, ArrayView<const Vec3f>, ArrayView<const int>);
template std::int64_t DividedParticles::findOwnOn(ThisBackend&, ArrayView<const Vec3f>, const BatchSelection&,
                                                  ArrayView<int>);
template void DividedParticles::countInLayersOn(ThisBackend&, ArrayView<const Vec3f>, const Count&,
                                                ArrayView<int>);
template void DividedParticles::placeLayerOn(ThisBackend&, const SortedLayers&, int, ArrayView<const int>,
                                             std::int64_t);

}  // namespace weir
