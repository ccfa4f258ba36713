// Neighbours of every particle within a radius, found once a step and walked many times.
#pragma once

#include <cstdint>

#include "framework/compute/cell_sort.h"
#include "nodes/particles/cell_grid.h"
#include "nodes/particles/particle_set.h"
#include "nodes/sink/sink_region.h"

namespace weir {

/// The lists as kernels see them. Entry k of particle i stands at ((i >> shift) * capacity + k) << shift | (i
/// & mask): on CUDA the lists of 32 particles are interleaved (shift 5), so that a warp reads whole lines. On
/// the CPU (shift 0) the capacity is a multiple of sixteen, and so is the number of entries of each list that
/// are indices of particles: those behind the neighbours mean nothing, but may be followed.
struct NeighborView {
  const int* entries = nullptr;
  const int* counts = nullptr;
  int capacity = 0;
  int shift = 0;

  WEIR_HD std::int64_t first(std::int64_t i) const {
    return (((i >> shift) * capacity) << shift) + (i & ((std::int64_t{1} << shift) - 1));
  }
};

/// Calls f(j) for every neighbour j of particle i; i itself is none of them.
template <class F>
WEIR_HD inline void forEachNeighbor(std::int64_t i, const NeighborView& list, F&& f) {
  const int count = list.counts[i];
  const int* entry = list.entries + list.first(i);
  const int stride = 1 << list.shift;
  int k = 0;
#ifdef __CUDA_ARCH__
  // A thread waits for memory most of the time: so four at once.
  for (; k + 4 <= count; k += 4, entry += 4 * stride) {
    const int j0 = entry[0], j1 = entry[stride], j2 = entry[2 * stride], j3 = entry[3 * stride];
    f(j0);
    f(j1);
    f(j2);
    f(j3);
  }
#endif
  for (; k < count; ++k, entry += stride) f(*entry);
}

/// The same lists, for kernels that take entries out of them.
struct NeighborEditor {
  int* entries = nullptr;
  int* counts = nullptr;
  NeighborView layout;

  /// Keeps those neighbours j of particle i for which keep(j) holds, in their order. Touches only i's own
  /// list, so lists may be edited side by side; they stay reciprocal if keep is symmetric. The threads of the
  /// team share the list.
  template <class Keep>
  WEIR_HD void keepIf(std::int64_t i, const Team& team, Keep&& keep) const {
    int* list = entries + layout.first(i);
    const int count = counts[i];
    int kept = 0;
    for (int first = 0; first < count; first += team.size) {
      const int k = first + team.lane;
      const int j = k < count ? list[static_cast<std::int64_t>(k) << layout.shift] : -1;
      const bool keeps = j >= 0 && keep(j);
      // All have read when the answers are there, and nobody writes behind what has been read.
      const unsigned all = team.ask(keeps);
      const int place = kept + countBits(all & ((1u << team.lane) - 1));
      if (keeps) list[static_cast<std::int64_t>(place) << layout.shift] = j;
      kept += countBits(all);
    }
    if (team.lane == 0) counts[i] = kept;
  }
};

/// Rare events of the search, counted on the device since the last reset.
struct NeighborEvents {
  int truncated = 0;  ///< lists that had more neighbours than there is room for
  int escaped = 0;    ///< particles that left the domain and were removed
  int nonFinite = 0;  ///< particles with a position or velocity that is no number, removed
};

/// Sorts particles by cell and builds the lists.
class NeighborList {
 public:
  explicit NeighborList(Device& device);

  /// Radius in m, and the longest list.
  void configure(float radius, int capacity);
  /// The shape of the grid; any shape gives the same neighbours. Where the particles have become twice as
  /// many, build() makes it larger by itself.
  void fitGrid(const Aabb& box, std::int64_t particles);

  /// Removes particles that are outside `domain`, in one of the `sinks` (on the device, counted there) or
  /// not finite, sorts the rest by cell, and finds for each all others closer than the radius. Lists are
  /// reciprocal unless truncated. Uses all scratch memory of the particles.
  void build(ParticleSet& particles, const Aabb& domain, ArrayView<const SinkPiece> sinks = {});

  /// Bytes on the device that lists and sorting take, in the largest grid, the particles' wideScratch() among
  /// them; after configure().
  double memoryFor(double particles) const;

  /// The shape of the grid, which decides the particles' order, and the events.
  void save(const StateWriter& to) const;
  void restore(const StateReader& from);

  NeighborView view() const;
  /// Σ_j (1 − r_ij/H)³ over all particles within the radius H at the search, i itself included: the sum of
  /// the spiky kernel over its value at 0, as a by-product. It stands in the particles' scratch(), so it is
  /// empty once someone else has asked for that.
  ArrayView<const float> crowding(const ParticleSet& particles) const {
    return particles.scratchUses() == crowdingUse_ ? crowding_ : ArrayView<const float>{};
  }
  NeighborEditor editor();
  int capacity() const { return capacity_; }
  // Both wait for the device.
  NeighborEvents eventsOnHost() const;
  std::vector<int> countsOnHost(std::int64_t particles) const { return counts_.toHost(particles); }

 private:
  /// All that lists of so many particles need, each array alone and without what it held before.
  void makeRoom(std::int64_t particles);
  /// Lists are interleaved in whole groups.
  std::int64_t paddedLists(std::int64_t particles) const {
    const std::int64_t lanes = std::int64_t{1} << shift_;
    return (particles + lanes - 1) / lanes * lanes;
  }
  template <class Backend>
  void buildOn(Backend& device, ParticleSet& particles, const Aabb& domain, ArrayView<const SinkPiece> sinks);
  template <class Backend>
  void listOn(Backend& device, const ParticleSet& particles, ArrayView<const int> cellStart, float* crowding);

  float radius_ = 0;
  int capacity_ = 0;
  int room_ = 0;  // for a list; at least the capacity
  int shift_ = 0;
  CellGrid grid_;
  Aabb box_;                    // that the grid was fitted to
  std::int64_t fittedFor_ = 0;  // particles
  Array<int> entries_, counts_;
  ArrayView<const float> crowding_;
  std::uint64_t crowdingUse_ = 0;  // of the scratch memory that it stands in
  Array<float> columns_;           // all x, all y, all z; on the CPU only
  Array<int> events_;              // NeighborEvents
};

}  // namespace weir
