#include "tests/nodes/geometry/sweep_kernel.h"

namespace weir::test {
namespace {

struct SweepAll {
  TriangleTreeView tree;
  float thickness;
  ArrayView<const Motion> motions;
  ArrayView<SweepResult> out;
  WEIR_HD void operator()(std::int64_t i) const {
    out[i] = sweep(tree, motions[i].from, motions[i].to, thickness, motions[i].towards);
  }
};

}  // namespace

template <class Backend>
void sweepAll(Backend& device, const TriangleTreeView& tree, float thickness, ArrayView<const Motion> motions,
              ArrayView<SweepResult> out) {
  parallelFor(device, "sweepAll", motions.size, SweepAll{tree, thickness, motions, out});
}

template void sweepAll(ThisBackend&, const TriangleTreeView&, float, ArrayView<const Motion>,
                       ArrayView<SweepResult>);

}  // namespace weir::test
