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
std::int64_t DividedParticles::findLeavingOn(Backend& device) {
  const Count count = particles_.count();
  found_.resizeDiscarding(count.bound);
  const OwnerOf ownerOf{onDevice(), ranks_.rank(), particles_.positions().read()};
  compact(device, "leave", count, Leaves{ownerOf}, found_.view(), foundCount_.data());
  const std::int64_t leaving = foundCount_.toHost().front();
  owners_.resizeDiscarding(leaving);
  parallelFor(device, "owners", leaving, WriteOwner{ownerOf, std::as_const(found_).view(), owners_.view()});
  return leaving;
}

template <class Backend>
void DividedParticles::countInLayersOn(Backend& device, ArrayView<int> counts) {
  parallelFor(device, "count in layers", particles_.count(),
              CountInLayers{slabs_.layers, particles_.positions().read(), counts});
}

template <class Backend>
void DividedParticles::placeLayerOn(Backend& device, const SortedLayers& sorted, int layer,
                                    ArrayView<const int> start, std::int64_t first) {
  parallelFor(device, "place layer", sorted.cellsInLayer + 1,
              PlaceLayer{start, static_cast<int>(first),
                         sorted.cellStart.data + std::int64_t{layer} * sorted.cellsInLayer});
}

template std::int64_t DividedParticles::findLeavingOn(ThisBackend&);
template void DividedParticles::countInLayersOn(ThisBackend&, ArrayView<int>);
template void DividedParticles::placeLayerOn(ThisBackend&, const SortedLayers&, int, ArrayView<const int>,
                                             std::int64_t);

}  // namespace weir
