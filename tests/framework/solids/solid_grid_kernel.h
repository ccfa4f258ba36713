// What a grid of solids says, and what each solid says for itself, on a device.
#pragma once

#include "framework/solids/solid_grid.h"
#include "framework/solids/solid_pairs.h"

namespace weir::test {

/// Of a place and a solid.
enum Answer : int {
  kListed = 1,             ///< by the grid, for somebody who has come in a straight line
  kListedThere = 2,        ///< by the grid, for the place alone
  kInReach = 4,            ///< its clearance there is at most the reach
  kMetFromBegin = 8,       ///< it may be met on the way, the solid being where the step begins, see isClear()
  kMetFromPredicted = 16,  ///< or where it was predicted
  kOutOfOrder = 32         ///< not listed after all before it
};

struct GridQuestion {
  SolidGridView grid;
  float reach, gap;
  ArrayView<const SolidView> solids;
  ArrayView<const Vec3f> starts, places;
};

/// answers[i · solids + k] of place i and solid k, once the grid has been sorted.
template <class Backend>
void askGrid(Backend& device, SolidGrid& grid, GridQuestion question, ArrayView<int> answers);

/// The pairs with that grid.
template <class Backend>
void findPairs(Backend& device, SolidPairs& pairs, const GridQuestion& question);

}  // namespace weir::test
