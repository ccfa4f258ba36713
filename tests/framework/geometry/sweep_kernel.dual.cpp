#include "tests/framework/geometry/sweep_kernel.h"

namespace weir::test {
namespace {

struct SweepAll {
  TriangleTreeView tree;
  ClearanceView clearance;
  float thickness;
  ArrayView<const Motion> motions;
  ArrayView<SweepResult> out;
  WEIR_HD void operator()(std::int64_t i) const {
    out[i] = sweep(tree, clearance, motions[i].from, motions[i].to, thickness, motions[i].towards);
  }
};

}  // namespace

template <class Backend>
void sweepAll(Backend& device, const TriangleTreeView& tree, const ClearanceView& clearance, float thickness,
              ArrayView<const Motion> motions, ArrayView<SweepResult> out) {
  parallelFor(device, "sweepAll", motions.size, SweepAll{tree, clearance, thickness, motions, out});
}

template void sweepAll(ThisBackend&, const TriangleTreeView&, const ClearanceView&, float,
                       ArrayView<const Motion>, ArrayView<SweepResult>);

}  // namespace weir::test
