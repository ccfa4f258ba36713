// Writes packed lists (packed_lists.h). The threads of a group's particles work side by side.
#pragma once

#include "framework/compute/parallel.h"
#include "framework/neighbors/packed_lists.h"

namespace weir {

/// The neighbours of one particle as they were found: those in the layer of cells below its own, then, from
/// `own` on, those in its layer, and from `above` on the others.
struct FoundNeighbors {
  Scratch index;
  int kept = 0;
  int own = 0, above = 0;
};

struct ListPacker {
  PackedLists lists;
  int* blocksWanted = nullptr;   // by the groups so far
  int* blocksMissing = nullptr;  // by how many groups in vain, since the reset
  bool allInWindows = false;     // every index is below kAllInWindows

  /// Writes list i and returns how many of `found` there was room for. All threads of the group must come
  /// here together: Threads answers `int least(int)` and `bool all(bool)` over them, and `int ofFirst(int)`,
  /// what the thread of the group's first particle has.
  template <class Threads>
  WEIR_HD int pack(std::int64_t i, const FoundNeighbors& found, const Threads& threads) const {
    ListGroup group;
    if (!allInWindows) group = chooseWindows(i, found, threads);
    if (i % kListGroup == 0) lists.groups[i / kListGroup] = group;
    if (group.wide == 0) {
      writeCodes(i, found, group);
      return found.kept;
    }
    const int room = lists.roomIn(group.wide), kept = found.kept < room ? found.kept : room;
    int* index = lists.indicesOf(i, group.wide);
    for (int k = 0; k < kept; ++k) index[k * kListGroup] = found.index[k];
    return kept;
  }

 private:
  template <class Threads>
  WEIR_HD ListGroup chooseWindows(std::int64_t i, const FoundNeighbors& found, const Threads& threads) const {
    ListGroup group;
    bool fits = true;
    for (int window = 0, k = 0; window < kWindows; ++window) {
      const int end = window == 0 ? found.own : (window == 1 ? found.above : found.kept);
      IndexSpan span;
      for (; k < end; ++k) span.add(found.index[k]);
      const int begin = threads.min(span.low);
      fits = fits && span.fits(begin);
      group.shift[window] = (begin == INT_MAX ? 0 : begin) - window * kWindow;
    }
    if (!threads.all(fits)) group.wide = placeOfIndices(i, found, threads);
    return group;
  }

  template <class Threads>
  WEIR_HD int placeOfIndices(std::int64_t i, const FoundNeighbors& found, const Threads& threads) const {
    constexpr int kInPlace = 1, kFirstBlock = 2;
    if (threads.all(found.kept <= lists.roomIn(kInPlace))) return kInPlace;
    const int block = threads.ofFirst(i % kListGroup == 0 ? atomicAdd(blocksWanted, 1) : 0);
    if (block < lists.blockCount) return kFirstBlock + block;
    if (i % kListGroup == 0) atomicAdd(blocksMissing, 1);
    return kInPlace;
  }

  WEIR_HD void writeCodes(std::int64_t i, const FoundNeighbors& found, const ListGroup& group) const {
    FourCodes* to = lists.codesOf(i);
    for (int k = 0; k < found.kept; k += kCodesTogether, to += kListGroup) {
      int code[kCodesTogether];
      for (int l = 0; l < kCodesTogether; ++l) {
        const int at = k + l;
        const int window = at < found.own ? 0 : (at < found.above ? 1 : 2);
        code[l] = at < found.kept ? group.encode(found.index[at], window) : 0;
      }
      *to = FourCodes::of(code[0], code[1], code[2], code[3]);
    }
  }
};

}  // namespace weir
