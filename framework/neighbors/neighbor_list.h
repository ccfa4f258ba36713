// Neighbours of every particle within a radius, found once a step and walked many times.
#pragma once

#include <cstdint>
#include <optional>

#include "framework/base/api.h"
#include "framework/communication/slabs.h"
#include "framework/compute/cell_sort.h"
#include "framework/compute/eight.h"
#include "framework/neighbors/cell_grid.h"
#include "framework/neighbors/packed_lists.h"
#include "framework/particles/fine_cell.h"
#include "framework/particles/particle_set.h"
#include "framework/particles/periodic_images.h"
#include "framework/particles/sink_region.h"
#include "framework/particles/sorted_layers.h"

namespace WEIR_API weir {

/// On the CPU, the lists of eight particles that stand side by side are interleaved: their k-th neighbours
/// stand together, and the next eight of one list are that many entries behind.
inline constexpr int kInterleaved = kEight;

// By-products of the search, for the particles' present positions: one of the two.

/// Σ_j (1 − r_ij/H)³ over all particles within the radius H at the search, i itself included: the sum of the
/// spiky kernel over its value at 0.
inline constexpr ByProduct<float> kCrowding{"crowding"};
/// Vec4f{x, y, z, crowding}, on CUDA, where somebody has leased ParticleSet::leasePlaces().
inline constexpr ByProduct<Vec4f> kPlaces{"places"};

/// The place of entry 0 of list i; entry k stands k * kInterleaved behind it.
WEIR_HD inline std::int64_t listPlace(std::int64_t i, int capacity) {
  const std::int64_t lane = i % kInterleaved;
  return (i - lane) * capacity + lane;
}

/// The lists as kernels see them. On the CPU they are interleaved. What stands behind the end of a list means
/// nothing, but the entries of all eight may be followed up to the end of the longest. On CUDA lists are
/// packed.
struct NeighborView {
  const int* entries = nullptr;
  const int* counts = nullptr;
  int capacity = 0;
  PackedLists packed;

  WEIR_HD bool isPacked() const { return packed.groups != nullptr; }
  WEIR_HD const int* list(std::int64_t i) const { return entries + listPlace(i, capacity); }
};

namespace detail {

template <class F>
WEIR_HD inline void forEachPacked(std::int64_t i, int count, const PackedLists& lists, F&& f) {
  const ListGroup group = lists.groups[i / kListGroup];
  const FourCodes* codes = lists.codesOf(i);
  const int* index = group.wide == 0 ? nullptr : lists.indicesOf(i, group.wide);
  // A thread waits for memory most of the time: so four neighbours at once, the last ones too.
  for (int k = 0; k < count; k += kCodesTogether) {
    int j[kCodesTogether];
    if (group.wide == 0) {
      const FourCodes four = *codes;
      four.to(j);
      codes += kListGroup;
      for (int l = 0; l < kCodesTogether; ++l) j[l] = k + l < count ? group.decode(j[l]) : -1;
    } else {
      for (int l = 0; l < kCodesTogether; ++l) j[l] = k + l < count ? index[l * kListGroup] : -1;
      index += kCodesTogether * kListGroup;
    }
    for (int l = 0; l < kCodesTogether; ++l)
      if (j[l] >= 0) f(j[l]);
  }
}

}  // namespace detail

/// Calls f(j) for every neighbour j of particle i; i itself is none of them.
template <class F>
WEIR_HD inline void forEachNeighbor(std::int64_t i, const NeighborView& list, F&& f) {
  const int count = list.counts[i];
#ifndef __CUDA_ARCH__
  if (!list.isPacked()) {
    const int* entry = list.list(i);
    for (int k = 0; k < count; ++k, entry += kInterleaved) f(*entry);
    return;
  }
#endif
  detail::forEachPacked(i, count, list.packed, f);
}

/// The same lists, for kernels that take entries out of them.
struct NeighborEditor {
  int* entries = nullptr;
  int* counts = nullptr;
  int capacity = 0;
  PackedLists packed;

  /// Keeps those neighbours j of particle i for which keep(j) holds, in their order. Touches only i's own
  /// list, so lists may be edited side by side; they stay reciprocal if keep is symmetric. The threads of the
  /// team share the list.
  template <class Keep>
  WEIR_HD void keepIf(std::int64_t i, const Team& team, Keep&& keep) const {
    if (packed.groups == nullptr) return keepIfOf(Entries32{entries + listPlace(i, capacity)}, i, team, keep);
    const ListGroup group = packed.groups[i / kListGroup];
    if (group.wide == 0)
      keepIfOf(Codes{packed, group, i}, i, team, keep);
    else
      keepIfOf(Indices{packed.indicesOf(i, group.wide)}, i, team, keep);
  }

 private:
  struct Entries32 {
    int* list;
    WEIR_HD int& at(int k) const { return list[k * kInterleaved]; }
    WEIR_HD int index(int entry) const { return entry; }
  };
  struct Indices {
    int* list;
    WEIR_HD int& at(int k) const { return list[k * kListGroup]; }
    WEIR_HD int index(int entry) const { return entry; }
  };
  struct Codes {
    PackedLists packed;
    ListGroup group;
    std::int64_t i;
    WEIR_HD std::uint16_t& at(int k) const { return *packed.code(i, k); }
    WEIR_HD int index(int code) const { return group.decode(code); }
  };

  template <class Entries, class Keep>
  WEIR_HD void keepIfOf(const Entries& list, std::int64_t i, const Team& team, Keep&& keep) const {
    const int count = counts[i];
    int kept = 0;
    for (int first = 0; first < count; first += team.size) {
      const int k = first + team.lane;
      const int entry = k < count ? list.at(k) : 0;
      const bool keeps = k < count && keep(list.index(entry));
      // All have read when the answers are there, and nobody writes behind what has been read.
      const unsigned all = team.ask(keeps);
      const int place = kept + countBits(all & ((1u << team.lane) - 1));
      if (keeps) list.at(place) = static_cast<std::remove_reference_t<decltype(list.at(0))>>(entry);
      kept += countBits(all);
    }
    if (team.lane == 0) counts[i] = kept;
  }
};

/// Rare events of the search, counted on the device since the last reset.
struct NeighborEvents {
  int truncated = 0;  ///< lists that had more neighbours than there is room for
  int escaped = 0;    ///< particles that left the domain and were removed
  int nonFinite = 0;  ///< particles with a position or velocity that is NaN or infinite, removed
  /// Not since the reset: groups of the last search that asked for a block (see packed_lists.h).
  int wideGroups = 0;
  /// Groups of lists that were cut off because no block was left. Which ones those are depends on the order
  /// in which threads come, so results may differ from run to run.
  int cutOffByOrder = 0;
};

/// Sorts particles by cell and builds the lists.
class NeighborList {
 public:
  explicit NeighborList(Device& device);

  /// Radius in m, and the longest list.
  void configure(float radius, int capacity);
  /// The shape of the grid; any shape gives the same neighbours. Where the particles have become twice as
  /// many, build() makes it larger by itself. The mean of their positions helps where the box has many cells.
  void fitGrid(const Aabb& box, std::int64_t particles, const std::optional<Vec3f>& mean = {});

  /// The grid that build() makes where it finds so many particles; where several sets share them, all of
  /// them.
  void fitMore(std::int64_t particles);
  /// Layers of cells: those of a set's slab of a fluid, and those of the fluid.
  struct Slab {
    CellLayers own, all;
  };
  /// The grid of a set that has a slab; the box is that of all particles, and so many they are.
  void fitSlab(const Slab& slab, const Aabb& box, std::int64_t particles);
  /// What the grid was fitted to.
  const Aabb& box() const { return box_; }

  /// Searches as every back end can, in place of the way that is fastest on this one: the same neighbours, in
  /// lists of another order. Tests compare the two.
  void usePortableSearch() { usesPortableSearch_ = true; }

  /// Has the particles of a cell stand in the order of their ids. Then every list has the order (cell, id),
  /// and sums over neighbours have the same bits however particles are divided among sets that have halos, if
  /// no teams add (parallelForSums).
  void orderByIds() { ordersByIds_ = true; }

  /// Removes particles that are outside `domain`, in one of the `sinks` (on the device, counted there) or
  /// not finite, sorts the rest by cell, and finds for each all others closer than the radius. Lists are
  /// reciprocal unless truncated. Takes all scratch memory of the particles meanwhile. With images, particles
  /// are wrapped into the box before, and neighbours are found through its faces, as a halo.
  void build(ParticleSet& particles, const Aabb& domain, ArrayView<const SinkPiece> sinks = {},
             PeriodicImages* images = nullptr);

  // The two halves of that, for those who put a halo behind the particles in between.
  /// Removes and sorts, owned particles alone.
  void sort(ParticleSet& particles, const Aabb& domain, ArrayView<const SinkPiece> sinks = {});
  /// Of a slab, between the two: where the halo's cells start is for its owner to say.
  SortedLayers sortedLayers() const { return {cellStart_, grid_.cellsInLayer(), grid_.slabLayers}; }
  /// Finds the neighbours of the owned particles among themselves and in the halo; those in the halo have
  /// none. With a halo, only kCrowding is found on the way. Comes after sort(), with nothing in between but
  /// packing and what is done to the halo.
  void list(ParticleSet& particles);

  /// Bytes on the device that lists and sorting take, in the largest grid, the particles' wide room among
  /// them; after configure().
  double memoryFor(double particles) const;

  /// The shape of the grid, which decides the particles' order, and the events. A slab is to be fitted anew.
  void save(const StateWriter& to) const;
  void restore(const StateReader& from);

  NeighborView view() const;
  NeighborEditor editor();
  int capacity() const { return capacity_; }
  /// How many neighbours each has, for as many particles as there was room for in the last search.
  ArrayView<const int> counts() const { return counts_.view(); }
  // Both wait for the device.
  NeighborEvents eventsOnHost();
  std::vector<int> countsOnHost(std::int64_t particles) const { return counts_.toHost(particles); }
  std::vector<std::vector<int>> listsOnHost(std::int64_t particles) const;

 private:
  /// All that lists of that many particles need, each array alone and without what it held before.
  void makeRoom(std::int64_t particles, std::int64_t halo = 0);
  static std::int64_t groupsOf(std::int64_t particles) { return (particles + kListGroup - 1) / kListGroup; }
  std::int64_t blocksFor(std::int64_t particles, std::int64_t halo = 0) const;
  PackedLists packed();
  template <class Backend>
  void sortOn(Backend& device, ParticleSet& particles, const Aabb& domain, ArrayView<const SinkPiece> sinks);
  template <class Backend>
  void mergeHaloOn(Backend& device, const ParticleSet& particles);
  template <class Backend>
  void listOn(Backend& device, const ParticleSet& particles, float* crowding, Vec4f* places);
  /// Whether there is a halo that stands anywhere, and not in the layers that a slab has room for.
  bool mergesHalo(const ParticleSet& particles) const { return particles.haloCount() > 0 && !slab_; }
  /// Of that many particles; a team of threads searches for each of fewer.
  bool needsFineCells(std::int64_t particles) const { return packs_ && particles > kFewForTeams; }

  /// More do as well with one thread each.
  static constexpr std::int64_t kFewForTeams = 1 << 15;

  float radius_ = 0;
  int capacity_ = 0;
  int room_ = 0;  // for a list; at least the capacity
  bool packs_;
  bool usesPortableSearch_ = false, ordersByIds_ = false;
  CellGrid grid_;
  std::optional<Slab> slab_;
  Aabb box_;                    // that the grid was fitted to
  std::int64_t fittedFor_ = 0;  // particles
  Array<int> entries_, counts_;
  // Where lists are packed.
  Array<ListGroup> groups_;
  Array<int> blocks_;
  int blocksWanted_ = 0;
  Array<float> columns_;  // all x, all y, all z; on the CPU only
  Array<int> events_;     // NeighborEvents
  // From sort() to list(), in the particles' wide room: where cells start, and fine cells, or null.
  Lease<Vec4f> sortedRoom_;
  ArrayView<int> cellStart_;
  FineCell* fine_ = nullptr;
  std::int64_t fineRoom_ = 0;
  // With a halo that is merged: its particles by cells, how many of them are in cells, and all in the order
  // of the search.
  CellSort haloCells_;
  Array<int> haloListed_;
  Array<int> mergedStart_, merged_, mergedPlaces_;  // see MergedOrder
};

}  // namespace weir
