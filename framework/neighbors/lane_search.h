// The search for neighbours on the CPU, which tests 16 candidates at a time and then eight lists at once.
//
// The particles of some cells that stand side by side share their candidates. These are copied from the nine
// rows of cells around them into one table, so that a particle's loop over them has no ends of rows, where a
// processor would guess wrong. Coordinates of 16 bits say who may be near (candidates.h). Distances are asked
// for where the lists of eight particles are walked to sum their crowding.
#pragma once

#include <algorithm>

#include "framework/neighbors/candidates.h"
#include "framework/neighbors/cell_grid.h"
#include "framework/neighbors/crowding.h"
#include "framework/neighbors/neighbor_list.h"

#ifdef WEIR_HAS_LANES

namespace weir::detail {

/// Finds the lists of ranges of owned particles. Candidates stand in an order, InPlace or MergedOrder, and
/// have places in it.
template <class Order>
struct LaneSearch {
  Order order;
  ShortPlaces places;
  ArrayView<const Vec3f> positions;
  ArrayView<const int> cellStart;
  CellGrid grid;
  float radiusSquared;
  int capacity;
  int room;  // for a list, a multiple of eight
  int* entries;
  int* counts;
  ArrayView<float> crowding;
  int* truncated;

  /// From `begin`, a multiple of eight, on.
  void operator()(std::int64_t begin, std::int64_t end) const {
    // A copy whose address nobody has, see parallelFor.
    const LaneSearch search = *this;
    Collector collector(search);
    // A processor hands on what it has just stored in the same pieces only. So lists are read in others while
    // those of the next eight particles are found.
    Group groups[2];
    int now = 0;
    for (std::int64_t i = begin; i < end; i += kEight, now = 1 - now) {
      collector.find(groups[now], static_cast<int>(i),
                     static_cast<int>(std::min<std::int64_t>(end - i, kEight)));
      if (i > begin) search.write(groups[1 - now]);
    }
    search.write(groups[1 - now]);
  }

 private:
  /// Eight particles side by side, or fewer, and who may be near them.
  struct Group {
    int first = 0, size = 0;
    alignas(32) int self[kEight];
    alignas(32) int found[kEight];
    // Interleaved like those that are to be made. What stands behind their ends are indices as well.
    alignas(32) int lists[(kMaxScratch + Candidates::kWrittenBehind) * kEight] = {};
  };

  /// Finds who may be near.
  struct Collector {
    const LaneSearch& search;
    int rowsEnd = 0;  // the place where the cells end that the rows are around
    int shift = 0;    // from the place of one of their particles to that in the table
    bool fits = true;
    // The places of the cells around them, those that stand side by side together.
    PlaceRange rows[27];
    int rowCount = 0;
    Candidates candidates;
    alignas(32) int reach[kEight];

    explicit Collector(const LaneSearch& of) : search(of) {}

    void find(Group& group, int first, int size) {
      prefetchPlacesOfLists(first);
      group.first = first, group.size = size;
      LaneInts::from(first).store(group.self);
      for (int l = size; l < kEight; ++l) group.self[l] = first;
      const Vec3<Lanes> p = gatherLanes(search.positions.data, group.self);
      const Lanes across = larger(abs(p.x), larger(abs(p.y), abs(p.z)));
      LaneInts{__builtin_convertvector(reachOf(search.grid.inverseCellSize * across).v, LaneInts::Vector)}
          .store(reach);
      for (int l = 0; l < size; ++l) group.found[l] = append(first + l, reach[l], group.lists + l);
      for (int l = size; l < kEight; ++l) group.found[l] = 0;
    }

    /// There are gaps between lists, which hardware does not foresee. Mostly they are no longer than this.
    void prefetchPlacesOfLists(int first) {
      constexpr int kAhead = 2, kLongest = 14, kInLine = 16, kToWrite = 1;
      const int* ahead = search.entries + listPlace(first, search.room) + kAhead * kEight * search.room;
      for (int k = 0; k < kLongest * kEight; k += kInLine) __builtin_prefetch(ahead + k, kToWrite);
    }

    static Lanes larger(const Lanes& a, const Lanes& b) { return select(a > b, a, b); }

    /// The list of those that may be near, or that are where these are too many.
    int append(int i, int within, int* list) {
      const int place = search.order.placeOf(i);
      if (place >= rowsEnd) collect(i);
      const int size = fits ? candidates.near(search.places[place], within,
                                              static_cast<unsigned>(place + shift), list, 0, search.capacity)
                            : appendByParts(place, within, list);
      return size <= search.capacity ? size : appendNear(i, list);
    }

    /// Where they are too many for one table.
    [[gnu::noinline]] int appendByParts(int place, int within, int* list) {
      int size = 0;
      for (int r = 0; r < rowCount; ++r)
        for (PlaceRange part = rows[r]; part.begin < rows[r].end && size <= search.capacity;
             part.begin = part.end) {
          part.end = std::min(part.begin + Candidates::kMax, rows[r].end);
          candidates.clear();
          candidates.add(search.places, part, search.order);
          candidates.close();
          const bool isHere = part.begin <= place && place < part.end;
          const unsigned own = isHere ? place - part.begin : Candidates::kNone;
          size = candidates.near(search.places[place], within, own, list, size, search.capacity);
        }
      return size;
    }

    /// One by one.
    [[gnu::noinline]] int appendNear(int i, int* list) {
      int size = 0;
      for (int r = 0; r < rowCount; ++r)
        for (int place = rows[r].begin; place < rows[r].end; ++place) {
          const int j = search.order.particleAt(place);
          if (j == i || !search.isNear(i, j)) continue;
          if (size < search.capacity) list[size * kEight] = j;
          ++size;
        }
      if (size > search.capacity) atomicAdd(search.truncated, 1);
      return std::min(size, search.capacity);
    }

    /// The candidates of the cell of i, and of three more where all four hold few. A candidate is less than
    /// five cells away along the row then, and counts as more than three if it is more than four.
    [[gnu::noinline]] void collect(int i) {
      const CellGrid& cellGrid = search.grid;
      const Vec3i cell = cellGrid.cellOf(search.positions[i]);
      const int* start = search.cellStart.data;
      const int own = cellGrid.index(cell);
      constexpr int kTogether = 4, kFew = 24;
      const bool holdFew =
          cell.x > 0 && cell.x + kTogether < cellGrid.cells.x && start[own + kTogether] - start[own] <= kFew;
      const int cells = holdFew ? kTogether : 1;
      rowsEnd = start[own + cells];
      rowCount = 0;
      int inAll = 0;
      const auto add = [&](int begin, int end) {
        rows[rowCount++] = {begin, end};
        inAll += end - begin;
      };
      const int y[] = {CellGrid::step(cell.y, -1, cellGrid.cells.y), cell.y,
                       CellGrid::step(cell.y, 1, cellGrid.cells.y)};
      const int z[] = {CellGrid::step(cell.z, -1, cellGrid.cells.z), cell.z,
                       CellGrid::step(cell.z, 1, cellGrid.cells.z)};
      if (cell.x > 0 && cell.x + cells < cellGrid.cells.x) {
        // The cells of a row stand side by side.
        for (const int layer : z)
          for (const int row : y) {
            const int* at = start + cellGrid.index({cell.x, row, layer});
            add(at[-1], at[cells + 1]);
          }
      } else {
        for (const int layer : z)
          for (const int row : y)
            for (int dx = -1; dx <= 1; ++dx) {
              const int* at =
                  start + cellGrid.index({CellGrid::step(cell.x, dx, cellGrid.cells.x), row, layer});
              add(at[0], at[1]);
            }
      }
      fits = inAll <= Candidates::kMax;
      if (!fits) return;
      candidates.clear();
      int r = 0;
      for (; r < rowCount / 2; ++r) candidates.add(search.places, rows[r], search.order);
      shift = candidates.add(search.places, rows[r++], search.order);
      for (; r < rowCount; ++r) candidates.add(search.places, rows[r], search.order);
      candidates.close();
    }
  };

  /// Writes the lists and the crowding of a group. Behind the ends of the shorter lists stand any particles.
  void write(Group& group) const {
    const LaneInts kept = LaneInts::load(group.found);
    const Vec3<Lanes> p = gatherLanes(positions.data, group.self);
    const int longest = largest(kept);
    const int* from = group.lists;
    int* to = entries + listPlace(group.first, room);
    Lanes crowd;
    LaneMask tooFar{};
    for (int k = 0; k < longest; ++k, from += kEight, to += kInterleaved) {
      const LaneMask listed = kept > k;
      LaneInts::load(from).store(to);
      const Vec3<Lanes> q = gatherLanes(positions.data, from);
      const Vec3<Lanes> d{q.x - p.x, q.y - p.y, q.z - p.z};
      const Lanes squared = dot(d, d);
      const LaneMask near = listed & (squared < Lanes(radiusSquared));
      tooFar = tooFar | (listed & !near);
      crowd += zeroUnless(near, crowdingAt(squared, grid));
    }
    const Lanes sum = 1 + crowd;
    for (unsigned bits = tooFar.bits(); bits != 0; bits &= bits - 1) removeFar(group, std::countr_zero(bits));
    if (group.size == kEight) {
      LaneInts::load(group.found).store(counts + group.first);
      sum.store(crowding.data + group.first);
    } else {
      for (int l = 0; l < group.size; ++l) counts[group.first + l] = group.found[l];
      for (int l = 0; l < group.size; ++l) crowding[group.first + l] = sum.v[l];
    }
  }

  void removeFar(Group& group, int lane) const {
    const int i = group.first + lane;
    int* list = entries + listPlace(i, room);
    int kept = 0;
    for (int k = 0; k < group.found[lane]; ++k) {
      const int j = list[k * kInterleaved];
      list[kept * kInterleaved] = j;
      kept += isNear(i, j) ? 1 : 0;
    }
    group.found[lane] = kept;
  }

  bool isNear(int i, int j) const {
    const Vec3f d = positions[j] - positions[i];
    return dot(d, d) < radiusSquared;
  }
};

}  // namespace weir::detail

#endif
