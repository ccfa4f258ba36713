// The search for neighbours of many particles on CUDA: it writes the codes of packed lists at once.
//
// The general search (FindNeighbors) writes indices into scratch memory, looks which windows they need, and
// encodes them. This one chooses windows first, around the cell of the group's first particle and those above
// and below it, so that what it finds is a code already. It asks beforehand where the nine rows of candidates
// begin and end; a group with candidates beyond its windows is left to the general search. What remains is
// the walk over the candidates, which has few instructions each.
#pragma once

#ifdef __CUDACC__

#include <algorithm>
#include <type_traits>

#include "framework/compute/parallel.h"
#include "nodes/particles/cell_rows.h"
#include "nodes/particles/crowding.h"
#include "nodes/particles/group_threads.h"

namespace weir {
namespace detail {

/// Memory of a thread in its block's shared memory, by addresses of 32 bits.
struct SharedBytes {
  unsigned at;

  __device__ void store16(unsigned byte, unsigned value) const {
    asm volatile("{ .reg .u16 half; cvt.u16.u32 half, %1; st.shared.u16 [%0], half; }" ::"r"(at + byte),
                 "r"(value));
  }
  __device__ void store32(unsigned byte, unsigned value) const {
    asm volatile("st.shared.u32 [%0], %1;" ::"r"(at + byte), "r"(value));
  }
  __device__ unsigned load32(unsigned byte) const {
    unsigned value;
    asm volatile("ld.shared.u32 %0, [%1];" : "=r"(value) : "r"(at + byte));
    return value;
  }
};

/// `Find` is the general search.
template <class Find>
struct CodeSearch {
  Find find;
  int words;  // of scratch memory for each thread, of four bytes

  /// For lists of at most `capacity` entries with room for `room`: codes and two more, and ranges; or what
  /// the general search needs. Odd, so that threads are in different banks.
  static int wordsFor(int capacity, int room) {
    const int needed = room / kCodesInInt + kBeyond + kRanges;
    return std::min(std::max(capacity, needed) | 1, kMostScratch);
  }

  __device__ void operator()(std::int64_t i, const Scratch& scratch) const {
    int* const block = scratch.data - threadIdx.x;
    const SharedBytes own{static_cast<unsigned>(__cvta_generic_to_shared(block)) +
                          threadIdx.x * static_cast<unsigned>(words) * 4};
    const GroupThreads threads(i, find.count.get());
    const Vec3f p = find.positions[i];
    const Surroundings around(find.grid, p);
    const ListGroup group = windowsAround(around, threads);
    if (!threads.all(noteRanges(p, around, group, own))) {
      // The general search interleaves what is the threads' own.
      threads.meet();
      const int lane = static_cast<int>(threadIdx.x) % kListGroup;
      return find(i, Scratch{block + (threadIdx.x - lane) * words + lane, kListGroup});
    }
    if (i % kListGroup == 0) lists().groups[i / kListGroup] = group;

    const int capacity = find.writer.capacity;
    Found found{own.at, own.at + 2 * static_cast<unsigned>(capacity + 1), 0};
    const auto search = [&](auto holdsOwn, int k, int row) {
      const int layer = k % kWindows;
      const int shift = layer == 0 ? group.shift[0] : (layer == 1 ? group.shift[1] : group.shift[2]);
      searchRange<decltype(holdsOwn)::value>(p, static_cast<int>(i),
                                             own.load32(rangesAt() + 4 * (3 * k + row)), shift, found);
    };
    search(std::true_type{}, 1, 1);
    for (int k = 0; k < (around.wraps() ? 2 * kWindows : kWindows); ++k)
      for (int row = 0; row < 3; ++row)
        if (k != 1 || row != 1) search(std::false_type{}, k, row);
    const int count = static_cast<int>(found.next - own.at) / 2;
    const int kept = count < capacity ? count : capacity;
    find.writer.crowd(i, p, found.crowd);
    writeList(i, own, kept);
    find.writer.finish(i, count, kept);
  }

 private:
  static constexpr int kRows = 9, kRanges = 2 * kRows;  // where the grid wraps around, a row is two ranges
  static constexpr int kBeyond = 1;                     // words of codes that tell that a list is too long
  static constexpr unsigned kNone = 1;                  // from 1 to 0

  /// Where the cells around a point are.
  struct Surroundings {
    Vec3i cell, cells;
    int y[3];
    int layer[3];  // z, times the rows of a layer

    __device__ Surroundings(const CellGrid& grid, const Vec3f& p) : cell(grid.cellOf(p)), cells(grid.cells) {
      for (int k = 0; k < 3; ++k) {
        y[k] = CellGrid::step(cell.y, k - 1, cells.y);
        layer[k] = CellGrid::step(cell.z, k - 1, cells.z) * cells.y;
      }
    }
    /// The first cell of a row, dy and dz in {0, 1, 2}.
    __device__ int row(int dy, int dz) const {
      return (layer[dz] + (dy == 0 ? y[0] : (dy == 1 ? y[1] : y[2]))) * cells.x;
    }
    __device__ bool wraps() const { return cell.x == 0 || cell.x + 1 == cells.x; }
    /// The neighbour of an end of a row.
    __device__ int otherEnd() const { return cell.x == 0 ? cells.x - 1 : 0; }
  };

  struct Found {
    unsigned next, end;  // where codes go
    float crowd;
  };

  __device__ const PackedLists& lists() const { return find.writer.packer.lists; }
  __device__ unsigned rangesAt() const {
    return static_cast<unsigned>(lists().capacity / kCodesInInt + kBeyond) * 4;
  }

  __device__ ListGroup windowsAround(const Surroundings& around, const GroupThreads& threads) const {
    ListGroup group;
    if (find.writer.packer.allInWindows) return group;
    for (int w = 0; w < kWindows; ++w) {
      const int middle = threads.ofFirst(find.cellStart[around.row(1, w) + around.cell.x]);
      group.shift[w] = middle - kWindow / 2 - w * kWindow;
    }
    return group;
  }

  /// The first and the last code of each range of candidates go to scratch memory. Returns whether all of
  /// them are in their windows.
  __device__ bool noteRanges(const Vec3f& p, const Surroundings& around, const ListGroup& group,
                             const SharedBytes& own) const {
    const RowsWithinReach rows(p, find.grid);
    bool fits = true;
#pragma unroll
    for (int dz = 0; dz < 3; ++dz) {
      const int shift = group.shift[dz];
      int low = INT_MAX, high = -1;
      const auto note = [&](int begin, int end, bool wanted, int slot) {
        const bool any = wanted && begin < end;
        low = any && begin < low ? begin : low;
        high = any && end > high ? end : high;
        const unsigned codes = static_cast<unsigned>(begin - shift) | static_cast<unsigned>(end - 1 - shift)
                                                                          << 16;
        own.store32(rangesAt() + 4 * slot, any ? codes : kNone);
      };
#pragma unroll
      for (int dy = 0; dy < 3; ++dy) {
        const RowPart part = rows(dy - 1, dz - 1);
        const int first = around.cell.x + part.first, end = around.cell.x + part.last + 1;
        const int* row = find.cellStart.data + around.row(dy, dz);
        note(row[first > 0 ? first : 0], row[end < around.cells.x ? end : around.cells.x],
             part.last >= part.first, 3 * dz + dy);
      }
      if (around.wraps()) {
#pragma unroll 1
        for (int dy = 0; dy < 3; ++dy) {
          const int* cell = find.cellStart.data + around.row(dy, dz) + around.otherEnd();
          note(cell[0], cell[1], true, kRows + 3 * dz + dy);
        }
      }
      const int least = shift + dz * kWindow;
      fits =
          fits && (find.writer.packer.allInWindows || high < 0 || (low >= least && high <= least + kWindow));
    }
    return fits;
  }

  template <bool kHoldsOwn>
  __device__ void searchRange(const Vec3f& p, int self, unsigned range, int shift, Found& found) const {
    constexpr float kFar = 1e30f;
    const int last = static_cast<int>(range >> 16), own = self - shift;
    int code = static_cast<int>(range & 0xffffu);
    const Vec3f* candidate = find.positions.data + (code + shift);
    // Two at a time, and no more: ranges of candidates are short. Where threads come to the end of theirs,
    // those with an odd number go along with the others.
#pragma unroll 1
    for (; code <= last; code += 2, candidate += 2) {
      const bool both = code < last;
      const Vec3f one = candidate[0];
      float x, y, z;
      if (both) x = candidate[1].x, y = candidate[1].y, z = candidate[1].z;
      const float nearer = squared(one - p), other = both ? squared(Vec3f{x, y, z} - p) : kFar;
      // For both; one entry too many tells that there are others.
      const bool room = found.next < found.end;
      test(nearer, code, room && (!kHoldsOwn || code != own), found);
      test(other, code + 1, room && (!kHoldsOwn || code + 1 != own), found);
    }
  }

  __device__ static float squared(const Vec3f& d) {
    return dot(d, d);
  }

  __device__ void test(float squared, int code, bool asked, Found& found) const {
    // Beyond the radius it adds 0, which costs less than to ask.
    found.crowd += crowdingAt(squared, find.grid);
    if (!(squared < find.radiusSquared && asked)) return;
    SharedBytes{found.next}.store16(0, static_cast<unsigned>(code));
    found.next += 2;
  }

  __device__ void writeList(std::int64_t i, const SharedBytes& own, int kept) const {
    FourCodes* to = lists().codesOf(i);
    for (int k = 0; k < kept; k += kCodesTogether, to += kListGroup) {
      const auto at = static_cast<unsigned>(k) * 2;
      *reinterpret_cast<uint2*>(to) = make_uint2(own.load32(at), own.load32(at + 4));
    }
  }
};

}  // namespace detail

/// Makes the lists of all particles, packed.
template <class Find>
void searchCodes(CudaDevice& device, std::string_view name, Count count, int capacity, const Find& find) {
  const int words = detail::CodeSearch<Find>::wordsFor(capacity, find.writer.packer.lists.capacity);
  parallelForWithScratch(device, name, count, words, detail::CodeSearch<Find>{find, words});
}

}  // namespace weir

#endif
