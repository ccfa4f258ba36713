// The search for neighbours on CUDA, which writes the codes of packed lists at once. Few particles are
// searched for by teams of threads (TeamSearch); what follows is about many, with a thread each (CodeSearch).
//
// The general search (FindNeighbors) writes indices into scratch memory, looks which windows they need, and
// encodes them. This one chooses windows first, around the cells of the group's particles and those above and
// below them, so that what it finds is a code already. A group with candidates beyond its windows is left
// to the general search.
//
// It goes over the candidates twice. First it asks of each by its FineCell whether it may be near, and notes
// the answers as bits, 32 candidates in a word. Then it measures the distance of those few for which the
// answer was yes.
#pragma once

#ifdef __CUDACC__

#include <algorithm>

#include "framework/compute/parallel.h"
#include "framework/neighbors/cell_rows.h"
#include "framework/neighbors/crowding.h"
#include "framework/neighbors/group_threads.h"
#include "framework/particles/fine_cell.h"

namespace weir {
namespace detail {

/// Memory of a thread in its block's shared memory, by addresses of 32 bits.
struct SharedBytes {
  unsigned at;

  __device__ void store16(unsigned value) const {
    asm volatile("{ .reg .u16 half; cvt.u16.u32 half, %1; st.shared.u16 [%0], half; }" ::"r"(at), "r"(value));
  }
  __device__ void storePair(uint2 value) const {
    asm volatile("st.shared.v2.u32 [%0], {%1, %2};" ::"r"(at), "r"(value.x), "r"(value.y));
  }
  __device__ uint2 loadPair() const {
    uint2 value;
    asm volatile("ld.shared.v2.u32 {%0, %1}, [%2];" : "=r"(value.x), "=r"(value.y) : "r"(at));
    return value;
  }
};

/// `Find` is the general search.
template <class Find>
struct CodeSearch {
  Find find;
  const FineCell* fine;
  int words;  // of scratch memory for each thread, of four bytes

  static constexpr int kBlocksTogether = 5;
  static constexpr Standing kLeaves = Standing::kCounts;

  /// For lists with room for `room`: codes, and more behind them that tell that a list is too long, and
  /// answers; or what the general search needs for lists of at most `capacity`. Pairs of words, an odd number
  /// of them, so that threads that use a pair each at a time are in different banks.
  static int wordsFor(int capacity, int room) {
    const int pairs = std::max((capacity + 1) / 2, wordsOfCodes(room) / 2 + kAnswers + 1) | 1;
    return std::min(2 * pairs, kMaxScratch);
  }

  __device__ void operator()(std::int64_t i, const Scratch& scratch) const {
    int* const block = scratch.data - threadIdx.x;
    const unsigned own = static_cast<unsigned>(__cvta_generic_to_shared(block)) +
                         threadIdx.x * static_cast<unsigned>(words) * 4;
    const GroupThreads threads(i, find.count.get());
    const Vec3f p = find.positions[i];
    const Rows rows(find.cellStart.data, find.grid, p);
    const ListGroup group = windowsAround(rows, threads);
    Answers answers{own + static_cast<unsigned>(wordsOfCodes(lists().capacity)) * 4,
                    own + static_cast<unsigned>(words) * 4};
    const bool fits = FineReach::covers(p, find.grid.inverseCellSize) && ask(p, rows, group, answers);
    if (!threads.all(fits)) return searchGenerally(find, i, scratch, threads);
    if (i % kListGroup == 0) lists().groups[i / kListGroup] = group;
    const int count = measure(static_cast<int>(i), p, group, answers, own);
    const int kept = count < find.writer.capacity ? count : find.writer.capacity;
    writeList(i, own, kept);
    find.writer.finish(i, count, kept);
  }

  /// By all threads of a group.
  template <class General>
  __device__ void searchGenerally(const General& general, std::int64_t i, const Scratch& scratch,
                                  const GroupThreads& threads) const {
    // It interleaves what is the threads' own.
    threads.meet();
    const int lane = static_cast<int>(threadIdx.x) % kListGroup;
    int* const block = scratch.data - threadIdx.x;
    general(i, Scratch{block + (threadIdx.x - lane) * words + lane, kListGroup});
  }

  /// Whether there is anything in the cells around a particle; `start` says where they start.
  __device__ bool hasAround(std::int64_t i, const int* start) const {
    const Rows rows(start, find.grid, find.positions[i]);
    int any = 0;
    for (int k = 0; k < kSide * kSide; ++k) {
      const Range row = rows(k / kSide, k % kSide);
      any |= row.end - row.begin;
    }
    return any != 0 || otherEndsHave(rows);
  }

 private:
  static constexpr int kSide = 3;     // cells around a particle, in each direction
  static constexpr int kAnswers = 9;  // words with an answer in them; there are that many rows
  static constexpr int kAtOnce = 4;   // candidates, no more: ranges of them are short
  static constexpr int kInWord = 32;  // candidates
  static_assert(kAtOnce <= FineCell::kAhead + 1);

  static __host__ __device__ constexpr int wordsOfCodes(int room) { return room / kCodesInInt + 2; }

  __device__ const PackedLists& lists() const { return find.writer.packer.lists; }

  struct Range {
    int begin, end;
  };

  /// The nine rows of cells around a particle, by layer, and where their candidates stand.
  struct Rows {
    const int* start;  // of each cell
    Vec3i cell, cells;

    __device__ Rows(const int* startOfCells, const CellGrid& grid, const Vec3f& p)
        : start(startOfCells), cell(grid.cellOf(p)), cells(grid.cells) {}

    __device__ Range operator()(int layer, int k) const {
      const unsigned row = rowAt(layer, k);
      const auto first = static_cast<unsigned>(cell.x > 0 ? cell.x - 1 : 0),
                 end = static_cast<unsigned>(cell.x + 1 < cells.x ? cell.x + 2 : cells.x);
      return {start[row + first], start[row + end]};
    }
    /// Where the grid wraps around beside the particle, rows have another cell at their other ends.
    __device__ bool wrap() const { return cell.x == 0 || cell.x + 1 == cells.x; }
    __device__ Range otherEnd(int layer, int k) const {
      const unsigned at = rowAt(layer, k) + static_cast<unsigned>(cell.x == 0 ? cells.x - 1 : 0);
      return {start[at], start[at + 1]};
    }

   private:
    __device__ unsigned rowAt(int layer, int k) const {
      const int y = near(cell.y, k, cells.y), z = near(cell.z, layer, cells.z);
      return static_cast<unsigned>((z * cells.y + y) * cells.x);
    }
    __device__ static int near(int c, int k, int n) {
      return k == 0 ? (c > 0 ? c - 1 : n - 1) : (k == 1 ? c : (c + 1 < n ? c + 1 : 0));
    }
  };

  /// Bits for candidates that may be near, the first of them the highest, and the code of the last: pairs of
  /// words in shared memory, behind each other. Behind the last stands a word without bits.
  struct Answers {
    unsigned next, last;   // where the next one goes, and where the last one may be, which means nothing
    unsigned highest = 0;  // place in a window

    __device__ Answers(unsigned begin, unsigned end) : next(begin), last(end - 8) {
      asm("" : "+r"(last));  // not worked out again for each row
    }

    __device__ void add(unsigned bits, int lastCode, int window) {
      SharedBytes{next < last ? next : last}.storePair({bits, static_cast<unsigned>(lastCode)});
      if (bits != 0) next += 8;
      // As if the word were full; below the window, it is a high number.
      const auto first = static_cast<unsigned>(lastCode - window * kWindow - (kInWord - 1));
      highest = first > highest ? first : highest;
    }
    __device__ bool areInWindows() const { return highest <= kWindow - kInWord; }
    /// Whether there was room for all.
    __device__ bool close() const {
      if (next > last) return false;
      SharedBytes{next}.storePair({0, 0});
      return true;
    }
  };

  __device__ ListGroup windowsAround(const Rows& rows, const GroupThreads& threads) const {
    ListGroup group;
    if (find.writer.packer.allInWindows) return group;
    // The least, because where the first is in the lowest layer of the grid, what is below it is the highest.
    for (int w = 0; w < kWindows; ++w)
      group.shift[w] = threads.min(rows(w, 1).begin) - kWindow / 2 - w * kWindow;
    return group;
  }

  /// In the order of the general search, so that nothing depends on which of them it was. Returns whether all
  /// candidates are in their windows, and there is room for the answers.
  __device__ bool ask(const Vec3f& p, const Rows& rows, const ListGroup& group, Answers answers) const {
    const FineReach reach(p, find.grid.inverseCellSize);
    if (otherEndsHave(rows)) {
#pragma unroll 1
      for (int k = 0; k < kSide * kSide; ++k) {
        const int layer = k / kSide;
        const Range row = rows(layer, k % kSide), other = rows.otherEnd(layer, k % kSide);
        askRange(reach, rows.cell.x == 0 ? other : row, group, layer, answers);
        askRange(reach, rows.cell.x == 0 ? row : other, group, layer, answers);
      }
    } else {
      Range row = rows(0, 0);
#pragma unroll
      for (int k = 0; k < kSide * kSide; ++k) {
        const int following = k + 1 < kSide * kSide ? k + 1 : k;
        const Range next = rows(following / kSide, following % kSide);  // is on its way meanwhile
        askRange(reach, row, group, k / kSide, answers);
        row = next;
      }
    }
    return answers.close() && (find.writer.packer.allInWindows || answers.areInWindows());
  }

  __device__ static bool otherEndsHave(const Rows& rows) {
    if (!rows.wrap()) return false;
    int any = 0;
#pragma unroll
    for (int layer = 0; layer < kSide; ++layer)
#pragma unroll
      for (int k = 0; k < kSide; ++k) {
        const Range other = rows.otherEnd(layer, k);
        any |= other.end - other.begin;
      }
    return any != 0;
  }

  __device__ void askRange(const FineReach& reach, Range range, const ListGroup& group, int window,
                           Answers& answers) const {
    auto [begin, end] = range;
    const int shift = window == 0 ? group.shift[0] : (window == 1 ? group.shift[1] : group.shift[2]);
#pragma unroll 1
    while (begin < end) {
      const int stop = begin + kInWord < end ? begin + kInWord : end;
      unsigned near = 0;
#pragma unroll 1
      do {
        const FineCell* const candidates = fine + static_cast<unsigned>(begin);
        int beyond[kAtOnce];
#pragma unroll
        for (int k = 0; k < kAtOnce; ++k) beyond[k] = reach.beyond(candidates[k]);
          // Their signs.
#pragma unroll
        for (int k = 0; k < kAtOnce; ++k) near = __funnelshift_l(static_cast<unsigned>(beyond[k]), near, 1);
        begin += kAtOnce;
      } while (begin < stop);
      // Those behind the last go.
      answers.add(near >> (begin - stop), stop - 1 - shift, window);
      begin = stop;
    }
  }

  /// Writes the codes of those that are near to `own`, and one too many to tell that there are others.
  /// Returns how many it wrote.
  __device__ int measure(int self, const Vec3f& p, const ListGroup& group, Answers answers,
                         unsigned own) const {
    const unsigned end = own + 2 * static_cast<unsigned>(find.writer.capacity + 1);
    const int selfCode = self - group.shift[1];
    unsigned next = own;
    float crowd = 0;
    uint2 answer = SharedBytes{answers.next}.loadPair();
    while (answer.x != 0) {
      const int bit = 31 - __clz(static_cast<int>(answer.x));
      const int code = static_cast<int>(answer.y) - bit;
      answer.x ^= 1u << bit;
      if (answer.x == 0) {
        answers.next += 8;
        answer = SharedBytes{answers.next}.loadPair();
      }
      const Vec3f d = find.positions[group.decode(code)] - p;
      const float squared = dot(d, d);
      // Beyond the radius it adds 0, which costs less than to ask.
      crowd += crowdingAt(squared, find.grid);
      if (squared < find.radiusSquared && code != selfCode && next < end) {
        SharedBytes{next}.store16(static_cast<unsigned>(code));
        next += 2;
      }
    }
    find.writer.crowd(self, p, crowd);
    return static_cast<int>(next - own) / 2;
  }

  __device__ void writeList(std::int64_t i, unsigned own, int kept) const {
    FourCodes* to = lists().codesOf(i);
#pragma unroll 1
    for (int k = 0; k < kept; k += kCodesTogether, to += kListGroup, own += sizeof(FourCodes))
      *reinterpret_cast<uint2*>(to) = SharedBytes{own}.loadPair();
  }
};

/// The same where particles have a halo, which stands far from its neighbours in memory: groups with some of
/// it in the cells around them are left to `Both`, the general search over both.
template <class Find, class Both>
struct CodeSearchBesideHalo {
  CodeSearch<Find> search;
  Both both;
  const int* haloStart;  // where the halo's cells start

  static constexpr int kBlocksTogether = CodeSearch<Find>::kBlocksTogether;
  static constexpr Standing kLeaves = CodeSearch<Find>::kLeaves;

  __device__ void operator()(std::int64_t i, const Scratch& scratch) const {
    const GroupThreads threads(i, search.find.count.get());
    if (threads.all(!search.hasAround(i, haloStart))) return search(i, scratch);
    search.searchGenerally(both, i, scratch, threads);
  }
};

/// A team searches for a particle, each of its threads in cells of its own, in fluids that do not fill the
/// device otherwise; all indices are codes there.
template <class Find>
struct TeamSearch {
  static constexpr Standing kLeaves = Standing::kCounts;
  Find find;

  __device__ void operator()(std::int64_t i, const Team& team) const {
    const int self = static_cast<int>(i);
    const Vec3f p = find.positions[i];
    const PackedLists& lists = find.writer.packer.lists;
    const RowsWithinReach rows(p, find.grid);
    const Vec3i own = find.grid.cellOf(p);
    constexpr int kCells = 27;
    int found = 0;
    float crowd = 0;
    for (int start = 0; start < kCells; start += team.size) {
      const int c = start + team.lane;
      int begin = 0, end = 0;
      if (c < kCells) range(own, c % 3 - 1, c / 3 % 3 - 1, c / 9 - 1, rows, begin, end);
      for (; team.ask(begin < end) != 0; begin += kTogether) {
        Vec3f at[kTogether];
        for (int l = 0; l < kTogether; ++l)
          if (begin + l < end) at[l] = find.positions[begin + l];
        for (int l = 0; l < kTogether; ++l) {
          const int j = begin + l;
          const Vec3f d = at[l] - p;
          const float squared = dot(d, d);
          if (j < end) crowd += crowdingAt(squared, find.grid);
          const bool near = j < end && squared < find.radiusSquared && j != self;
          const unsigned all = team.ask(near);
          const int place = found + countBits(all & ((1u << team.lane) - 1));
          if (near && place < find.writer.capacity) *lists.code(i, place) = static_cast<std::uint16_t>(j);
          found += countBits(all);
        }
      }
    }
    crowd = team.sum(crowd);
    if (team.lane != 0) return;
    if (i % kListGroup == 0) lists.groups[i / kListGroup] = ListGroup{};
    find.writer.finish(i, found, found < find.writer.capacity ? found : find.writer.capacity);
    find.writer.crowd(i, p, crowd);
  }

 private:
  static constexpr int kTogether = 4;  // candidates of a cell

  __device__ void range(const Vec3i& own, int dx, int dy, int dz, const RowsWithinReach& rows, int& begin,
                        int& end) const {
    const CellGrid& grid = find.grid;
    const RowPart part = rows(dy, dz);
    if (dx < part.first || dx > part.last) return;
    const int c =
        grid.index({CellGrid::step(own.x, dx, grid.cells.x), CellGrid::step(own.y, dy, grid.cells.y),
                    CellGrid::step(own.z, dz, grid.cells.z)});
    begin = find.cellStart[c];
    end = find.cellStart[c + 1];
  }
};

}  // namespace detail

/// Makes the lists of all particles, packed: of at most kFew, which have no fine cells, by teams.
template <std::int64_t kFew, class Find>
void searchOnGpu(CudaDevice& device, std::string_view name, Count count, int capacity, const Find& find,
                 const FineCell* fine) {
  constexpr TeamPlan kPlan{Team::kMax, kFew};
  if (fine == nullptr) return parallelForTeams<kPlan>(device, name, count, detail::TeamSearch<Find>{find});
  const int words = detail::CodeSearch<Find>::wordsFor(capacity, find.writer.packer.lists.capacity);
  parallelForWithScratch(device, name, count, words, detail::CodeSearch<Find>{find, fine, words});
}

/// The same beside a halo, of particles that have fine cells.
template <class Find, class Both>
void searchBesideHalo(CudaDevice& device, std::string_view name, Count count, int capacity, const Find& find,
                      const Both& both, const FineCell* fine, const int* haloStart) {
  const int words = detail::CodeSearch<Find>::wordsFor(capacity, find.writer.packer.lists.capacity);
  parallelForWithScratch(
      device, name, count, words,
      detail::CodeSearchBesideHalo<Find, Both>{detail::CodeSearch<Find>{find, fine, words}, both, haloStart});
}

}  // namespace weir

#endif
