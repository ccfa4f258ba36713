#include "plugins/openvdb/density_grid.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <array>
#include <cmath>
#include <sstream>

#include "framework/base/error.h"
#include "framework/base/file_output.h"

namespace weir {

namespace {

using Accessor = openvdb::FloatGrid::Accessor;

/// The voxel below a coordinate, and how far above its middle that is, in voxels.
struct Along {
  int voxel = 0;
  float above = 0;
};

Along along(float coordinate, float side) {
  const float at = coordinate / side, below = std::floor(at);
  return {static_cast<int>(below), at - below};
}

bool isNear(const Vec3f& p, float side) {
  constexpr float kFarthest = 1e9f;  // voxels
  return std::abs(p.x) < kFarthest * side && std::abs(p.y) < kFarthest * side &&
         std::abs(p.z) < kFarthest * side;
}

void addParticle(const Vec3f& position, float share, float side, Accessor& voxels) {
  const std::array<Along, 3> at{along(position.x, side), along(position.y, side), along(position.z, side)};
  for (int corner = 0; corner < 8; ++corner) {
    float weight = share;
    openvdb::Coord voxel;
    for (int axis = 0; axis < 3; ++axis) {
      const Along& here = at[static_cast<std::size_t>(axis)];
      const int up = corner >> axis & 1;
      voxel[axis] = here.voxel + up;
      weight *= up != 0 ? here.above : 1 - here.above;
    }
    if (weight > 0) voxels.modifyValue(voxel, [weight](float& value) { value += weight; });
  }
}

}  // namespace

void writeDensity(const std::filesystem::path& file, const std::vector<ParticleVolume>& fluids, float side,
                  double time) {
  openvdb::initialize();
  const openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(0);
  grid->setName("density");
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(side));
  grid->setSaveFloatAsHalf(true);
  grid->insertMeta("time", openvdb::DoubleMetadata(time));
  Accessor voxels = grid->getAccessor();
  for (const ParticleVolume& fluid : fluids)
    for (std::size_t i = 0; i < fluid.positions.size(); ++i)
      if (isNear(fluid.positions[i], side))
        addParticle(fluid.positions[i], fluid.volumeOf(i) / (side * side * side), side, voxels);
  std::ostringstream bytes;
  try {
    openvdb::io::Stream(bytes).write(openvdb::GridCPtrVec{grid});
  } catch (const openvdb::Exception& error) {
    throw ioError("OpenVDB cannot make the file: " + std::string(error.what())).at({.file = file.string()});
  }
  writeFileAtomically(file, bytes.view());
}

}  // namespace weir
