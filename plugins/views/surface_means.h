// What the particles of a fluid have where its surface is: velocities for motion blur, and colours.
#pragma once

#include <span>
#include <vector>

#include "plugins/views/near_particles.h"

namespace weir::rendering {

/// Of each place (m), the mean of the vectors, one for each particle, of those that are near, by their
/// weights; zero where there is none, or the place is not finite.
std::vector<Vec3f> meansAt(std::span<const Vec3f> places, const NearParticles& particles,
                           std::span<const Vec3f> vectors);

}  // namespace weir::rendering
