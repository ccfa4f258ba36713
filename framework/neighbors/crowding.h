// What the search for neighbours sums on its way, see kCrowding.
#pragma once

#include "framework/compute/lanes.h"
#include "framework/neighbors/cell_grid.h"

namespace weir {

/// What a particle at this distance, squared, adds to the crowding, or eight of them.
template <class T>
WEIR_HD T crowdingAt(const T& squared, const CellGrid& grid) {
  const T t = positivePart(1 - fastSqrt(squared) * grid.inverseCellSize);
  return t * t * t;
}

}  // namespace weir
