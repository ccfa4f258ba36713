// Where the particles of a slab stand once they are sorted by cells.
#pragma once

#include "framework/compute/array.h"

namespace weir {

/// By the cells of the slab's layers, from the lowest one on; and behind these, room for the same of the
/// layer above the slab and of the one below it.
struct SortedLayers {
  ArrayView<int> cellStart;  ///< on the device: (layers + 2)·cellsInLayer + 1 of them
  int cellsInLayer = 0;      ///< in the same order on all ranks
  int layers = 0;
};

}  // namespace weir
