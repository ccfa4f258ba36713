// A set of particles that several ranks share: each owns those in its slab of space (slabs.h).
//
//   divided.migrate();                           // to where they belong
//   neighbors.sort(particles, …);
//   divided.showHalo();                          // copies of what is beside each slab
//   neighbors.list(particles);
//   …
//   divided.refresh({"position", "velocity"});   // of the copies, wherever neighbours are read next
//
// All ranks make the same calls in the same order. The other way round, whatever kernels only write to owned
// particles needs no call.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/communication/communicator.h"
#include "framework/communication/slabs.h"
#include "framework/graph/state.h"
#include "framework/particles/particle_batch.h"
#include "framework/particles/particle_set.h"

namespace WEIR_API weir {

class DividedParticles {
 public:
  /// Cells of that size, m; all particles belong to rank 0 at first. The devices of all ranks must outlive
  /// those of all.
  DividedParticles(Communicator& ranks, ParticleSet& particles, float cellSize);
  ~DividedParticles();

  Communicator& ranks() const { return ranks_; }
  const Slabs& slabs() const { return slabs_; }

  /// Cuts space anew, for particles in this box of all ranks. Particles stay where they are until the next
  /// migrate().
  void cut(const Aabb& box);
  /// The same for particles that every rank has.
  void cut(const std::vector<Vec3f>& positions);
  /// Adds those of a batch, which every rank has and selects from alike, that belong to this rank.
  void append(const ParticleBatch& batch, const BatchSelection& selected = {});
  /// Takes what belongs to this rank of a saved set, which every rank reads, in place of all that it has.
  void restore(const StateReader& from);

  /// Owned particles go to the ranks that their positions belong to; those that are not finite stay.
  void migrate();
  /// Sends the particles beside other slabs to their ranks, with position and id, and takes those as halo.
  void showHalo();
  /// Replaces these attributes of the halo by what its owners have.
  void refresh(std::initializer_list<std::string_view> attributes);
  /// The same for an array that has an element for each particle of the set, the halo behind the others.
  template <class T>
  void refresh(ArrayView<T> values) {
    static_assert(sizeof(T) % sizeof(std::uint32_t) == 0);
    constexpr int kWords = sizeof(T) / sizeof(std::uint32_t);
    refreshWords({reinterpret_cast<std::uint32_t*>(values.data), kWords * values.size}, kWords);
  }
  /// The same for so many words of each.
  void refreshWords(ArrayView<std::uint32_t> words, int wordsInOne);
  /// Adds all particles of all ranks, with all attributes that are not derived, to a set that is there on
  /// rank 0 only and null elsewhere, in no order. Ids go on there as they do here.
  void gather(ParticleSet* all);

  /// How many particles all ranks own.
  std::int64_t countOfAll();

 private:
  /// What a neighbour sees of this rank, and where its particles are in the halo.
  struct Neighbor {
    explicit Neighbor(Device& device) : shown(device) {}
    int rank = 0;
    Array<int> shown;
    HaloRange halo;
  };

  /// Those of a set that every rank has.
  void appendOwn(ParticleSet& all);
  void cutLayersOf(const Aabb& box, const std::vector<Vec3f>& positions, bool ofAllRanks);
  SlabsView onDevice() const;
  Parcel packed(const PackLayout& layout, ArrayView<const int> indices);
  /// The next parcel of a rank.
  const Parcel& nextOf(int rank);
  /// Its bytes on this rank's device, until the next call.
  ArrayView<const std::byte> unpackedOf(int rank);
  /// Gives the memory of all parcels that have come back to their senders.
  void releaseParcels();

  // Both leave indices in `found_`; how many is returned, once the device has told.
  template <class Backend>
  std::int64_t findLeavingOn(Backend& device);
  template <class Backend>
  std::int64_t findShownOn(Backend& device, int rank);
  template <class Backend>
  void gatherWordsOn(Backend& device, ArrayView<const std::uint32_t> words, int wordsInOne,
                     ArrayView<const int> indices, Array<std::byte>& to);

  Communicator& ranks_;
  ParticleSet& particles_;
  Slabs slabs_;
  Array<int> cuts_;  // of the slabs, on the device
  Array<int> found_, foundCount_, owners_;
  Array<std::byte> buffer_;
  std::vector<Parcel> parcels_;  // which the device may still be reading
  std::vector<Neighbor> neighbors_;
};

}  // namespace weir
