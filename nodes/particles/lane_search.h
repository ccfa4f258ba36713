// The search for neighbours on the CPU, which tests eight candidates at a time.
//
// The particles of a cell share their candidates. These are copied from the nine rows of cells around it into
// one table, so that a particle's loop over them has no ends of rows, where a processor would guess wrong.
// The lists of eight particles are interleaved when all of them are found.
#pragma once

#include <algorithm>

#include "framework/compute/eight.h"
#include "nodes/particles/cell_grid.h"
#include "nodes/particles/crowding.h"
#include "nodes/particles/neighbor_sum.h"

#ifdef WEIR_HAS_LANES

namespace weir::detail {

/// The coordinates of particles in columns. Behind each column there is room for eight more.
struct Columns {
  float* x;
  float* y;
  float* z;

  Columns(Array<float>& memory, std::int64_t particles) {
    const std::int64_t height = (particles + 2 * Lanes::kCount - 1) / Lanes::kCount * Lanes::kCount;
    memory.resizeDiscarding(3 * height);
    x = memory.data(), y = x + height, z = y + height;
  }
};

struct FillColumns {
  ArrayView<const Vec3f> positions;
  Columns columns;

  template <class Index>
  void operator()(Index i) const {
    const auto p = read(positions, i);
    write(ArrayView<float>{columns.x, positions.size}, i, p.x);
    write(ArrayView<float>{columns.y, positions.size}, i, p.y);
    write(ArrayView<float>{columns.z, positions.size}, i, p.z);
  }
};

/// Places [begin, end) of sorted particles.
struct PlaceRange {
  int begin, end;
};

/// Those who may be near the particles of a cell.
class Candidates {
 public:
  static constexpr int kMost = 1024;

  void clear() { size_ = 0; }

  /// There must be room for all.
  void add(const Columns& columns, const PlaceRange& places) {
    int at = size_;
    size_ += places.end - places.begin;
    // Nearly always one turn; of an empty range, too, because a wrong guess costs more.
    int j = places.begin;
    do {
      Lanes::load(columns.x + j).store(x_ + at);
      Lanes::load(columns.y + j).store(y_ + at);
      Lanes::load(columns.z + j).store(z_ + at);
      LaneInts::from(j).store(index_ + at);
      j += Lanes::kCount, at += Lanes::kCount;
    } while (j < places.end);
  }

  /// What stands behind the last is made to be near nobody.
  void close() { Lanes(kFar).store(x_ + size_); }

  /// Writes those that are near p, but for `self`, behind the first `found` ones of a list that keeps at most
  /// `room` and has space for eight more. Returns how many have been found then.
  int near(const Vec3f& p, float radiusSquared, int self, int* list, int found, int room) const {
    for (int k = 0; k < size_; k += Lanes::kCount) {
      const Vec3<Lanes> d{Lanes::load(x_ + k) - p.x, Lanes::load(y_ + k) - p.y, Lanes::load(z_ + k) - p.z};
      const LaneInts index = LaneInts::load(index_ + k);
      const LaneMask near = (dot(d, d) < Lanes(radiusSquared)) & (index != self);
      found += storeChosen(list + (found < room ? found : room), index, near.bits());
    }
    return found;
  }

 private:
  static constexpr float kFar = 1e30f;

  int size_ = 0;
  // With room for a turn more.
  alignas(32) float x_[kMost + Lanes::kCount];
  alignas(32) float y_[kMost + Lanes::kCount];
  alignas(32) float z_[kMost + Lanes::kCount];
  alignas(32) int index_[kMost + Lanes::kCount];
};

/// Eight rows of eight become columns.
inline void transpose(LaneInts::Vector rows[kEight]) {
  LaneInts::Vector pairs[kEight], fours[kEight];
  for (int r = 0; r < kEight; r += 2) {
    pairs[r] = __builtin_shufflevector(rows[r], rows[r + 1], 0, 8, 1, 9, 4, 12, 5, 13);
    pairs[r + 1] = __builtin_shufflevector(rows[r], rows[r + 1], 2, 10, 3, 11, 6, 14, 7, 15);
  }
  for (int r = 0; r < kEight; r += 4)
    for (int half = 0; half < 2; ++half) {
      const LaneInts::Vector a = pairs[r + half], b = pairs[r + 2 + half];
      fours[r + 2 * half] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
      fours[r + 2 * half + 1] = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
    }
  for (int c = 0; c < kEight / 2; ++c) {
    rows[c] = __builtin_shufflevector(fours[c], fours[c + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    rows[c + 4] = __builtin_shufflevector(fours[c], fours[c + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

/// Finds the lists of ranges of particles.
struct LaneSearch {
  Columns columns;
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
    Group group{*this};
    for (std::int64_t i = begin; i < end; i += kEight) {
      const auto size = static_cast<int>(end - i < kEight ? end - i : kEight);
      group.find(static_cast<int>(i), size);
      group.interleave(static_cast<int>(i), size);
      sumCrowding(i, size);
    }
  }

 private:
  /// The places of the 27 cells around one, those that stand side by side together.
  struct Rows {
    int count = 0;
    int places = 0;  // in all of them
    PlaceRange at[27];

    void clear() { count = places = 0; }
    void add(int begin, int end) {
      at[count++] = {begin, end};
      places += end - begin;
    }
  };

  /// Eight particles side by side.
  struct Group {
    const LaneSearch& search;
    int cellEnd = 0;   // the place where the present cell ends
    bool fits = true;  // all its candidates into the table
    Rows rows;
    Candidates candidates;
    int kept[kEight] = {};
    int lists[kEight][kMostScratch + 3 * kEight];

    explicit Group(const LaneSearch& of) : search(of) {}

    void find(int first, int size) {
      for (int i = first; i < first + size; ++i) {
        if (i >= cellEnd) collect(i);
        finish(i, i - first, fits ? append(i, i - first, 0) : appendByParts(i, i - first));
      }
    }

    /// The candidates of the cell of i.
    void collect(int i) {
      const Columns& columns = search.columns;
      const Vec3i cell = search.grid.cellOf({columns.x[i], columns.y[i], columns.z[i]});
      cellEnd = search.cellStart[search.grid.index(cell) + 1];
      search.findRows(cell, rows);
      fits = rows.places <= Candidates::kMost;
      if (!fits) return;
      candidates.clear();
      for (int r = 0; r < rows.count; ++r) candidates.add(columns, rows.at[r]);
      candidates.close();
    }

    /// Where they are too many for one table.
    int appendByParts(int i, int lane) {
      int found = 0;
      for (int r = 0; r < rows.count; ++r) {
        for (PlaceRange part = rows.at[r]; part.begin < rows.at[r].end; part.begin = part.end) {
          part.end = std::min(part.begin + Candidates::kMost, rows.at[r].end);
          candidates.clear();
          candidates.add(search.columns, part);
          candidates.close();
          found = append(i, lane, found);
        }
      }
      return found;
    }

    int append(int i, int lane, int found) {
      const Columns& c = search.columns;
      return candidates.near({c.x[i], c.y[i], c.z[i]}, search.radiusSquared, i, lists[lane], found,
                             search.room);
    }

    void finish(int i, int lane, int found) {
      kept[lane] = found < search.capacity ? found : search.capacity;
      if (found > search.capacity) atomicAdd(search.truncated, 1);
      search.counts[i] = kept[lane];
    }

    /// Writes the lists. Behind the ends of the shorter ones stand the particles themselves.
    void interleave(int first, int size) {
      int longest = 0;
      for (int l = 0; l < size; ++l) longest = kept[l] > longest ? kept[l] : longest;
      for (int l = 0; l < kEight; ++l) {
        const LaneInts self{LaneInts::Vector{} + (l < size ? first + l : first)};
        for (int k = l < size ? kept[l] : 0; k < longest; k += kEight) self.store(lists[l] + k);
      }
      int* to = search.entries + listPlace(first, search.room);
      for (int k = 0; k < longest; k += kEight, to += kEight * kInterleaved) {
        LaneInts::Vector block[kEight];
        for (int l = 0; l < kEight; ++l) block[l] = LaneInts::load(lists[l] + k).v;
        transpose(block);
        for (int c = 0; c < kEight; ++c) LaneInts{block[c]}.store(to + c * kInterleaved);
      }
    }
  };

  /// The places of all cells around one.
  void findRows(const Vec3i& cell, Rows& rows) const {
    const bool inside = cell.x > 0 && cell.x + 1 < grid.cells.x;
    rows.clear();
    for (int dz = -1; dz <= 1; ++dz) {
      const int z = CellGrid::step(cell.z, dz, grid.cells.z);
      for (int dy = -1; dy <= 1; ++dy) {
        const int y = CellGrid::step(cell.y, dy, grid.cells.y);
        const int row = (z * grid.cells.y + y) * grid.cells.x;
        if (inside) {
          // The cells of a row stand side by side.
          rows.add(cellStart[row + cell.x - 1], cellStart[row + cell.x + 2]);
          continue;
        }
        for (int dx = -1; dx <= 1; ++dx) {
          const int c = row + CellGrid::step(cell.x, dx, grid.cells.x);
          rows.add(cellStart[c], cellStart[c + 1]);
        }
      }
    }
  }

  /// The lists are still in the cache.
  void sumCrowding(std::int64_t first, int size) const {
#ifdef WEIR_HAS_EIGHT
    if (size == kEight) return sumCrowding(Eight{first});
#endif
    for (std::int64_t i = first; i < first + size; ++i) sumCrowding(i);
  }

  template <class Index>
  void sumCrowding(Index i) const {
    const auto p = read(positions, i);
    const auto term = [&]<class T>(const auto&, const Vec3<T>& q) {
      const Vec3<T> d{q.x - p.x, q.y - p.y, q.z - p.z};
      return crowdingAt(dot(d, d), grid);
    };
    const NeighborView list{entries, counts, room, {}};
    write(crowding, i, 1 + sumOverNeighbors<float>(i, list, term, positions));
  }
};

}  // namespace weir::detail

#endif
