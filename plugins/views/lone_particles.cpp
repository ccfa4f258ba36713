#include "plugins/views/lone_particles.h"

#include <vector>

#include "framework/compute/dispatch.h"

namespace weir::rendering {

void LoneParticles::find(ArrayView<const Vec3f> positions, float spacing) {
  constexpr float kCell = 1.5f;  // spacings
  lone_.resizeDiscarding(positions.size);
  others_.resizeDiscarding(positions.size);
  if (positions.size == 0) return;
  dispatch(device_, [&](auto& device) { findOn(device, positions, kCell * spacing); });
  const std::vector<int> kept = kept_.toHost();
  lone_.resizeDiscarding(kept[0]);
  others_.resizeDiscarding(kept[1]);
}

}  // namespace weir::rendering
