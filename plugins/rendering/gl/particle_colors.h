// The colours of particles as a row of texels, of which ColorEntries chooses.
#pragma once

#include <cstdint>
#include <vector>

#include "plugins/rendering/compute/sphere_kernels.h"
#include "plugins/views/view.h"

namespace weir::rendering::gl {

/// The texels as SplatSphere::color packs them: the colour map, the fixed colour and that of NaN.
std::vector<std::uint32_t> particleColors(const ParticleView& particles);

}  // namespace weir::rendering::gl
