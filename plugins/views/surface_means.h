// What the particles of a fluid have where its surface is: velocities for motion blur, and colours.
#pragma once

#include <span>
#include <vector>

#include "framework/geometry/dynamic_mesh_copy.h"
#include "plugins/views/near_particles.h"

namespace weir::rendering {

/// Of each place (m), the mean of the vectors, one for each particle, of those that are near, by their
/// weights; zero where there is none, or the place is not finite.
std::vector<Vec3f> meansAt(std::span<const Vec3f> places, const NearParticles& particles,
                           std::span<const Vec3f> vectors);

/// Vectors of the vertices of a closed mesh, mixed along it as by a Gaussian with this standard deviation
/// (m): each pass gives a vertex the mean of those that share an edge with it, and adds half the mean square
/// of the edges' lengths to the variance along each direction.
std::vector<Vec3f> mixedAlong(const MeshSpan& mesh, std::vector<Vec3f> vectors, float deviation);

}  // namespace weir::rendering
