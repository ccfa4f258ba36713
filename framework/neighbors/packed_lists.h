// Neighbour lists in 16 bits an entry, as CUDA keeps them: half the memory, and half the bytes to read in
// each walk over the lists.
//
// The lists of 32 particles that stand side by side, a group, share three windows of indices. Particles are
// sorted by cell, layer by layer of the grid, so the neighbours of a group lie in three stretches, one in
// each of the layers below, at and above its own. An entry is a code: the window, and the place in it. Four
// codes of a list stand together and are read at once; those of the 32 lists are interleaved.
//
// Where a window is too narrow, because the group's particles or rows of the grid lie far apart, the group is
// wide: its entries are indices. They have the place of the group's codes while no list has more than half of
// what it may have, and otherwise take one of a few blocks that are kept for this. Where these run out, lists
// are cut off at half; which ones depends on who comes first.
#pragma once

#include <climits>
#include <cstdint>

#include "framework/base/api.h"
#include "framework/base/host_device.h"

namespace WEIR_API weir {

inline constexpr int kListGroup = 32;     // lists
inline constexpr int kCodesTogether = 4;  // of a list
inline constexpr int kCodesInInt = 2;
inline constexpr int kWindows = 3;
inline constexpr int kWindow = 21845;                   // indices; three windows make 16 bits
inline constexpr std::int64_t kAllInWindows = 1 << 16;  // that many particles need no search for windows

/// What decodes the entries of a group.
struct alignas(16) ListGroup {
  /// What a code in each window lacks to the index.
  int shift[kWindows] = {0, 0, 0};
  /// 0 for codes; for indices 1 where the codes would be, and 2 + b in block b.
  int wide = 0;

  WEIR_HD int decode(int code) const {
    return code + (code < kWindow ? shift[0] : (code < 2 * kWindow ? shift[1] : shift[2]));
  }
  WEIR_HD int encode(int index, int window) const {
    // No array that is indexed at run time, which CUDA would put into memory.
    return index - (window == 0 ? shift[0] : (window == 1 ? shift[1] : shift[2]));
  }
};

/// The least and the largest index of some entries.
struct IndexSpan {
  int low = INT_MAX, high = -1;

  WEIR_HD void add(int index) {
    low = index < low ? index : low;
    high = index > high ? index : high;
  }
  WEIR_HD bool fits(int begin) const { return high < 0 || high - begin < kWindow; }
};

/// Four codes as they stand in memory.
struct alignas(8) FourCodes {
  std::uint32_t low, high;

  /// Of numbers from 0 to 65535.
  WEIR_HD static FourCodes of(int a, int b, int c, int d) {
    return {static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b) << 16,
            static_cast<std::uint32_t>(c) | static_cast<std::uint32_t>(d) << 16};
  }
  WEIR_HD void to(int (&codes)[kCodesTogether]) const {
    codes[0] = static_cast<int>(low & 0xffffu);
    codes[1] = static_cast<int>(low >> 16);
    codes[2] = static_cast<int>(high & 0xffffu);
    codes[3] = static_cast<int>(high >> 16);
  }
};

/// Where the lists of a device stand; `capacity`, the most entries of a list, is a multiple of
/// kCodesTogether.
struct PackedLists {
  FourCodes* codes = nullptr;
  ListGroup* groups = nullptr;  // null where lists are not packed
  int* blocks = nullptr;        // for wide groups, capacity · kListGroup indices each
  int blockCount = 0;
  int capacity = 0;

  /// The first four codes of list i. The next four of the same list are kListGroup elements on.
  WEIR_HD FourCodes* codesOf(std::int64_t i) const { return codesOfGroup(i) + place(i); }
  /// The k-th code of list i.
  WEIR_HD std::uint16_t* code(std::int64_t i, int k) const {
    const auto at = static_cast<std::uint32_t>(k);
    return reinterpret_cast<std::uint16_t*>(codesOf(i) + at / kCodesTogether * kListGroup) +
           at % kCodesTogether;
  }
  /// The first index of list i in a group with this `wide`. The next one is kListGroup elements on.
  WEIR_HD int* indicesOf(std::int64_t i, int wide) const {
    int* group = wide == 1 ? reinterpret_cast<int*>(codesOfGroup(i))
                           : blocks + std::int64_t{wide - 2} * capacity * kListGroup;
    return group + place(i);
  }
  /// The most entries of a list in such a group.
  WEIR_HD int roomIn(int wide) const { return wide == 1 ? capacity / 2 : capacity; }

  WEIR_HD ListGroup* groupOf(std::int64_t i) const { return groups + number(i); }

 private:
  // By numbers without signs, which are divided by shifts.
  WEIR_HD static std::uint32_t number(std::int64_t i) { return static_cast<std::uint32_t>(i) / kListGroup; }
  WEIR_HD static std::uint32_t place(std::int64_t i) { return static_cast<std::uint32_t>(i) % kListGroup; }
  WEIR_HD FourCodes* codesOfGroup(std::int64_t i) const {
    const std::uint32_t ofGroup = static_cast<std::uint32_t>(capacity) / kCodesTogether * kListGroup;
    return codes + std::uint64_t{number(i)} * ofGroup;
  }
};

}  // namespace weir
