// Neighbour lists one behind the other, for those who sum over them elsewhere, such as kernels of Python.
//
//   for (int k = offsets[i]; k < offsets[i + 1]; ++k) f(indices[k]);
#pragma once

#include "framework/compute/array.h"
#include "framework/neighbors/neighbor_list.h"

namespace weir {

/// On the device of the lists.
struct NeighborRows {
  Array<int> offsets;  ///< one more than there are particles; the last one is the number of all entries
  Array<int> indices;  ///< in the order of the lists
};

/// The lists of the first `particles` particles as they are now; waits for the device. Throws a simulation
/// Error if they have more than 2,147,483,647 entries.
NeighborRows rowsOf(Device& device, const NeighborList& lists, std::int64_t particles);

namespace detail {

template <class Backend>
void countRows(Backend& device, const NeighborView& lists, std::int64_t particles, NeighborRows& rows,
               Array<double>& total);
template <class Backend>
void fillRows(Backend& device, const NeighborView& lists, std::int64_t particles, NeighborRows& rows);

}  // namespace detail

}  // namespace weir
