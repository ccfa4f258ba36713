// Which particles of a set others own or see.
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

struct IsSeenBy {
  SlabsView slabs;
  int rank;
  ArrayView<const Vec3f> positions;
  WEIR_HD bool operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    return isFinite(p) && slabs.touches(rank, p);
  }
};

struct GatherWords {
  ArrayView<const std::uint32_t> words;
  int wordsInOne;
  ArrayView<const int> indices;
  std::uint32_t* to;

  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = indices[k];
    for (int w = 0; w < wordsInOne; ++w) to[k * wordsInOne + w] = words[i * wordsInOne + w];
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
std::int64_t DividedParticles::findShownOn(Backend& device, int rank) {
  const Count count = particles_.count();
  found_.resizeDiscarding(count.bound);
  compact(device, "show", count, IsSeenBy{onDevice(), rank, particles_.positions().read()}, found_.view(),
          foundCount_.data());
  return foundCount_.toHost().front();
}

template <class Backend>
void DividedParticles::gatherWordsOn(Backend& device, ArrayView<const std::uint32_t> words, int wordsInOne,
                                     ArrayView<const int> indices, Array<std::byte>& to) {
  to.resizeDiscarding(indices.size * wordsInOne * std::int64_t{sizeof(std::uint32_t)});
  parallelFor(device, "pack", indices.size,
              GatherWords{words, wordsInOne, indices, reinterpret_cast<std::uint32_t*>(to.data())});
}

template std::int64_t DividedParticles::findLeavingOn(ThisBackend&);
template std::int64_t DividedParticles::findShownOn(ThisBackend&, int);
template void DividedParticles::gatherWordsOn(ThisBackend&, ArrayView<const std::uint32_t>, int,
                                              ArrayView<const int>, Array<std::byte>&);

}  // namespace weir
