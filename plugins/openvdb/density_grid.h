// The volume that particles fill, as an OpenVDB file. Only this folder includes OpenVDB.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "framework/base/vec.h"

namespace weir {

struct ParticleVolume {
  std::span<const Vec3f> positions;  ///< m
  float volume = 0;                  ///< of a particle, m³
  std::span<const float> volumes;    ///< of each particle in place of that; empty where all have the same

  float volumeOf(std::size_t i) const { return volumes.empty() ? volume : volumes[i]; }
};

/// Writes a sparse grid "density", a fog volume: the share of each voxel that is filled, about 1 within a
/// fluid, as 16-bit floating-point numbers. Voxel (i, j, k) is a cube around (i, j, k)·side, in m. Each
/// particle's volume is shared between the eight voxels around it, linearly in its distance from their
/// middles, so volume and centre of mass are kept. Particles at places that are not finite, or farther than
/// 10⁹ voxels away, are left out. The file replaces one of that name when it is whole. Throws an io Error.
void writeDensity(const std::filesystem::path& file, const std::vector<ParticleVolume>& fluids, float side,
                  double time);

}  // namespace weir
