// The search where particles have a halo (ParticleSet::appendHalo): cell by cell, owned ones and those of the
// halo are merged, so that a list has the order (cell, id) whoever owns the particles in it.
#pragma once

#include "framework/neighbors/cell_rows.h"
#include "framework/neighbors/crowding.h"
#include "framework/neighbors/group_threads.h"
#include "framework/neighbors/list_packer.h"

namespace weir {

/// The halo by the cells of the grid. It stays where it is, so its indices stand in `order`.
struct HaloCells {
  ArrayView<const int> start;  // of each cell in `order`
  ArrayView<const int> order;  // places in the halo
  int first = 0;               // the halo's first index
  ArrayView<const std::int64_t> ids;

  WEIR_HD int index(int k) const { return first + order[k]; }
};

/// `Find` is the search of every back end.
template <class Find>
struct FindWithHalo {
  Find find;
  HaloCells halo;

  WEIR_HD void operator()(std::int64_t i, const Scratch& scratch) const {
    FoundNeighbors to{scratch};
    const int found = search(i, to);
    find.writer.finish(i, found, find.writer.packer.pack(i, to, GroupThreads(i, find.count.get())));
  }

  /// Returns how many there are.
  WEIR_HD int search(std::int64_t i, FoundNeighbors& to) const {
    const Vec3f p = find.positions[i];
    Found found{find, to.index, p, static_cast<int>(i)};
    const RowsWithinReach rows(p, find.grid);
    const Vec3i own = find.grid.cellOf(p), cells = find.grid.cells;
    int ownLayer = 0, above = 0;
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        const RowPart part = rows(dy, dz);
        for (int dx = part.first; dx <= part.last; ++dx)
          searchCell(find.grid.index({CellGrid::step(own.x, dx, cells.x), CellGrid::step(own.y, dy, cells.y),
                                      CellGrid::step(own.z, dz, cells.z)}),
                     found);
      }
      if (dz < 0) ownLayer = found.count;
      if (dz <= 0) above = found.count;
    }
    // As the fastest search of the CPU adds it up: the particle itself last.
    find.writer.crowd(i, p, 1 + found.crowd);
    const auto upToCapacity = [&](int k) { return k < find.writer.capacity ? k : find.writer.capacity; };
    to.kept = upToCapacity(found.count);
    to.own = upToCapacity(ownLayer);
    to.above = upToCapacity(above);
    return found.count;
  }

 private:
  struct Found {
    const Find& find;
    const Scratch& list;
    Vec3f p;
    int self;
    int count = 0;
    float crowd = 0;

    WEIR_HD void offer(int j) {
      const Vec3f d = find.positions[j] - p;
      const float squared = dot(d, d);
      if (squared >= find.radiusSquared || j == self) return;
      crowd += crowdingAt(squared, find.grid);
      if (count < find.writer.capacity) list[count] = j;
      ++count;
    }
  };

  WEIR_HD void searchCell(int cell, Found& found) const {
    int j = find.cellStart[cell], k = halo.start[cell];
    const int end = find.cellStart[cell + 1], haloEnd = halo.start[cell + 1];
    while (j < end || k < haloEnd) {
      const bool takesOwn = k == haloEnd || (j < end && halo.ids[j] < halo.ids[halo.index(k)]);
      found.offer(takesOwn ? j++ : halo.index(k++));
    }
  }
};

/// Puts the particles of each cell into the order of their ids, where order[k] for start[c] ≤ k < start[c +
/// 1] are those of cell c; the id of particle order[k] is ids[first + order[k]].
struct OrderCellByIds {
  ArrayView<const int> start;
  ArrayView<int> order;
  ArrayView<const std::int64_t> ids;
  std::int64_t first = 0;

  WEIR_HD void operator()(std::int64_t c) const {
    // Few, and mostly in order.
    for (int end = start[c] + 1; end < start[c + 1]; ++end) {
      const int moved = order[end];
      const std::int64_t id = ids[first + moved];
      int k = end;
      for (; k > start[c] && ids[first + order[k - 1]] > id; --k) order[k] = order[k - 1];
      order[k] = moved;
    }
  }
};

}  // namespace weir
