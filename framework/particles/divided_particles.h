// A set of particles that several ranks share: each owns those in its slab of space (slabs.h).
//
//   divided.migrate();                           // to where they belong
//   neighbors.sort(particles, …);
//   divided.showHalo(neighbors.sortedLayers());  // copies of what is beside each slab
//   neighbors.list(particles);
//   …
//   divided.refresh({"position", "velocity"});   // of the copies, wherever neighbours are read next
//
// All ranks make the same calls in the same order. The other way round, whatever kernels only write to owned
// particles needs no call.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/communication/slabs.h"
#include "framework/communication/timed_ranks.h"
#include "framework/graph/state.h"
#include "framework/particles/particle_batch.h"
#include "framework/particles/particle_set.h"
#include "framework/particles/sorted_layers.h"

namespace WEIR_API weir {

/// What ParticleSet::save() has of each particle.
void saveRows(const ParticleSet& particles, const StateWriter& to);

class DividedParticles {
 public:
  /// Cells of that size, m; all particles belong to rank 0 at first. The devices of all ranks must outlive
  /// those of all.
  DividedParticles(Communicator& ranks, ParticleSet& particles, float cellSize);
  ~DividedParticles();

  Communicator& ranks() { return ranks_; }
  /// What the calls below took, and what was exchanged by way of ranks().
  RankTimes& times() { return ranks_.times(); }
  /// The layers of cells that are this rank's, and all.
  CellLayers ownLayers() const { return slabs_.layersOf(ranks_.rank()); }
  const CellLayers& allLayers() const { return slabs_.layers; }
  const Slabs& slabs() const { return slabs_; }

  /// Divides space as another set does, whose particles these go with. Particles stay where they are until
  /// the next migrate().
  void follow(const Slabs& slabs);
  /// Cuts space anew, for particles in this box of all ranks. Particles stay as above.
  void cut(const Aabb& box);
  /// The same for particles that every rank has, in arrays on its device.
  void cut(const Aabb& box, const std::vector<ArrayView<const Vec3f>>& positions);
  /// Adds those of a batch, which every rank has and selects from alike, that belong to this rank.
  void append(const ParticleBatch& batch, const BatchSelection& selected = {});
  /// What a checkpoint has of them once: all but the rows, of which each rank saves its own by saveRows().
  /// Together they are what ParticleSet::restore() takes, with the rows of ranks behind each other.
  void save(const StateWriter& to) const;
  /// Takes what belongs to this rank of a saved set in place of all that it has. Of a set that several ranks
  /// saved, each reads a share, and they exchange what belongs to others; of another one, each has all. Space
  /// is cut for the box that it was cut for, or stays divided as it is.
  void restore(const StateReader& from, const Aabb& box);
  void restore(const StateReader& from);

  /// Owned particles go to the ranks that their positions belong to; those that are not finite stay.
  void migrate();
  /// The same as if they stood at these points.
  void migrate(ArrayView<const Vec3f> points);
  /// Sends the particles beside other slabs to their ranks, with position and id, and takes those as halo, in
  /// the order of cells; writes where these begin, too.
  void showHalo(const SortedLayers& sorted);
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
  /// Puts all particles of all ranks, with all attributes that are shown, into an empty set that is there on
  /// rank 0 only and null elsewhere: those of each rank in their order, one rank after the other. Ids go on
  /// there as they do here.
  void gather(ParticleSet* all);

  /// How many particles all ranks own.
  std::int64_t countOfAll();

  /// Bytes on the device that this takes where so many are owned, and so many are in the halo of a rank
  /// between two others.
  static double memoryFor(double owned, double halo = 0);

 private:
  /// A rank that touches this one: the layer that it sees of this rank, and where its particles are in the
  /// halo.
  struct Neighbor {
    int rank = 0;
    int shownLayer = 0;
    std::int64_t first = 0, count = 0;  // of the particles in it
    HaloRange halo;
  };

  /// Takes the rows that there are as this rank's own.
  void readShare(const StateReader& from);
  /// Reads a set that every rank has, with the attributes of this one.
  void read(const StateReader& from, ParticleSet& all) const;
  /// Those of it that are this rank's, in place of all that it has.
  void takeOwn(ParticleSet& all);
  /// Sends these particles, in ascending order, to where they belong, and takes what others send at the same
  /// time.
  void exchange(const std::vector<int>& leaving, const std::vector<int>& owners);
  void cutLayersOf(const std::vector<std::int64_t>& particlesInLayers);
  SlabsView onDevice() const;
  void findNeighborRanks(const SortedLayers& sorted);
  Parcel packed(const PackLayout& layout, ArrayView<const int> indices);
  Parcel packed(const PackLayout& layout, const Neighbor& neighbor);
  /// Ends a round: what these ranks have sent, until the next call.
  std::span<const Parcel> received(const std::vector<int>& from);
  /// The ranks that touch this one, each so many times.
  std::vector<int> neighborRanks(int times) const;
  /// The bytes of one that was received, on this rank's device, until the next call.
  ArrayView<const std::byte> unpacked(const Parcel& parcel);
  /// Gives the memory of all parcels that have come back to their senders.
  void releaseParcels();

  /// Where space was cut anew, no more leave at a time than this part of a fair share.
  static constexpr std::int64_t kParts = 64;
  /// How many particles a message to rank 0 has at most: those of MPI have less than 2 GiB.
  static constexpr std::int64_t kAtOnce = std::int64_t{1} << 25;
  /// Calls take(parcel) on rank 0 with an attribute of all others, of which each rank owns so many.
  template <class T, class Take>
  void bring(std::string_view attribute, const std::vector<std::int64_t>& counts, const Take& take);
  template <class T>
  Parcel packed(std::string_view attribute, std::int64_t first);
  void gatherIds(const std::vector<std::int64_t>& counts, ParticleSet* all);
  template <class T>
  void gather(const AttributeInfo& info, const std::vector<std::int64_t>& counts, ParticleSet* all);

  template <class Backend>
  void countInLayersOn(Backend& device, ArrayView<const Vec3f> positions, const Count& count,
                       ArrayView<int> counts);
  /// Writes which of these particles, all or those that are selected, belong to this rank; returns how many,
  /// once the device has told.
  template <class Backend>
  std::int64_t findOwnOn(Backend& device, ArrayView<const Vec3f> positions, const BatchSelection& selected,
                         ArrayView<int> own);
  /// Leaves indices in `found_`; how many is returned, once the device has told.
  template <class Backend>
  std::int64_t findLeavingOn(Backend& device, ArrayView<const Vec3f> points);
  /// Leaves in `owners_` whose these are.
  template <class Backend>
  void findOwnersOn(Backend& device, ArrayView<const Vec3f> points, ArrayView<const int> indices);
  template <class Backend>
  void placeLayerOn(Backend& device, const SortedLayers& sorted, int layer, ArrayView<const int> start,
                    std::int64_t first);

  TimedRanks ranks_;
  ParticleSet& particles_;
  float cellSize_;
  Slabs slabs_;
  Array<int> cuts_;  // of the slabs, on the device
  Array<int> found_, foundCount_, owners_, ends_;
  Array<std::byte> buffer_;
  std::vector<Parcel> parcels_;  // which the device may still be reading
  std::vector<Neighbor> neighbors_;
  std::int64_t atOnce_ = std::int64_t{1} << 16;  // particles that leave a rank at a time, where many do
  bool cutAnew_ = true;                          // since the last migration
};

}  // namespace weir
