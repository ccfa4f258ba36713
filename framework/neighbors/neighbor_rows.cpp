#include "framework/neighbors/neighbor_rows.h"

#include <limits>

#include "framework/base/error.h"
#include "framework/compute/dispatch.h"
#include "framework/compute/parallel.h"

namespace weir {

NeighborRows rowsOf(Device& device, const NeighborList& lists, std::int64_t particles) {
  NeighborRows rows{.offsets = Array<int>(device, particles + 1), .indices = Array<int>(device)};
  Array<double> total(device, 1);
  rows.offsets.fillZero();
  if (particles == 0) return rows;
  dispatch(device, [&](auto& backend) { detail::countRows(backend, lists.view(), particles, rows, total); });
  const double entries = total.toHost().front();
  if (entries > std::numeric_limits<int>::max())
    throw simulationError("there are more than 2,147,483,647 pairs of neighbours", "fewer particles");
  rows.indices.resizeDiscarding(static_cast<std::int64_t>(entries));
  dispatch(device, [&](auto& backend) { detail::fillRows(backend, lists.view(), particles, rows); });
  return rows;
}

}  // namespace weir
