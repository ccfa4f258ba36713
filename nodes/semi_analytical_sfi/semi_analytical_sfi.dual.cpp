#include "nodes/semi_analytical_sfi/semi_analytical_sfi.h"

#include "framework/compute/parallel.h"
#include "framework/solids/carve.h"

namespace weir {

namespace {

/// Whether particles lie in a solid, or so near that there is no room for them.
struct MarkInside {
  ArrayView<const SolidView> solids;
  float gap;  // m
  ArrayView<const Vec3f> positions;
  ArrayView<int> inside;

  WEIR_HD void operator()(std::int64_t i) const {
    bool in = false;
    for (std::int64_t k = 0; k < solids.size && !in; ++k) in = hasNoRoom(solids[k], positions[i], gap);
    inside[i] = in ? 1 : 0;
  }
};

}  // namespace

template <class Backend>
void SemiAnalyticalSFI::markInsideOn(Backend& device, const Fluid& in, const Array<SolidView>& views,
                                     Array<int>& inside) {
  parallelFor(device, "carve", inside.size(),
              MarkInside{views.view(), kCarveGap * in.constants->spacing,
                         std::as_const(*in.particles).positions().view(), inside.view()});
}

template void SemiAnalyticalSFI::markInsideOn(ThisBackend&, const Fluid&, const Array<SolidView>&,
                                              Array<int>&);

}  // namespace weir
