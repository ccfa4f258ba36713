#include "framework/neighbors/neighbor_rows.h"

#include "framework/compute/parallel.h"
#include "framework/compute/reductions.h"

namespace weir::detail {

namespace {

struct LengthOf {
  const int* counts;
  WEIR_HD double operator()(std::int64_t i) const { return counts[i]; }
};

struct CopyLength {
  const int* counts;
  ArrayView<int> to;
  WEIR_HD void operator()(std::int64_t i) const { to[i] = counts[i]; }
};

struct CopyList {
  NeighborView lists;
  ArrayView<const int> offsets;
  ArrayView<int> indices;
  WEIR_HD void operator()(std::int64_t i) const {
    std::int64_t at = offsets[i];
    forEachNeighbor(i, lists, [&](int j) { indices[at++] = j; });
  }
};

}  // namespace

template <class Backend>
void countRows(Backend& device, const NeighborView& lists, std::int64_t particles, NeighborRows& rows,
               Array<double>& total) {
  reduce(device, "pairs", particles, 0.0, LengthOf{lists.counts}, Plus{}, total.data());
  parallelFor(device, "lengths of lists", particles, CopyLength{lists.counts, rows.offsets.view()});
  exclusiveScan(device, rows.offsets.view(), rows.offsets.view(), rows.offsets.size());
}

template <class Backend>
void fillRows(Backend& device, const NeighborView& lists, std::int64_t particles, NeighborRows& rows) {
  parallelFor(device, "rows of lists", particles, CopyList{lists, rows.offsets.view(), rows.indices.view()});
}

template void countRows(ThisBackend&, const NeighborView&, std::int64_t, NeighborRows&, Array<double>&);
template void fillRows(ThisBackend&, const NeighborView&, std::int64_t, NeighborRows&);

}  // namespace weir::detail
