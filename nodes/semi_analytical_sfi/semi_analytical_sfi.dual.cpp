#include "nodes/semi_analytical_sfi/semi_analytical_sfi.h"

#include <limits>

#include "framework/compute/parallel.h"

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
    for (std::int64_t k = 0; k < solids.size && !in; ++k) in = isIn(solids[k], positions[i]);
    inside[i] = in ? 1 : 0;
  }

  WEIR_HD bool isIn(const SolidView& solid, const Vec3f& position) const {
    const Vec3f p = solid.end.toBody(position);
    // Only what is near a sheet matters; a side can be far from its surface.
    const float reach = solid.kind == SolidKind::kSheet ? gap : std::numeric_limits<float>::infinity();
    const SurfacePoint nearest = solid.tree.nearest(p, reach);
    if (nearest.triangle < 0) return false;
    if (nearest.distance < gap) return true;
    if (solid.kind == SolidKind::kSheet) return false;
    return (nearest.side < 0) == (solid.kind == SolidKind::kSolid);
  }
};

}  // namespace

template <class Backend>
void SemiAnalyticalSFI::markInsideOn(Backend& device, const Fluid& in, const Array<SolidView>& views,
                                     Array<int>& inside) {
  constexpr float kGap = 0.25f;  // spacings
  parallelFor(device, "carve", inside.size(),
              MarkInside{views.view(), kGap * in.constants->spacing,
                         std::as_const(*in.particles).positions().view(), inside.view()});
}

template void SemiAnalyticalSFI::markInsideOn(ThisBackend&, const Fluid&, const Array<SolidView>&,
                                              Array<int>&);

}  // namespace weir
