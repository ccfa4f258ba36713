#include "plugins/vtkhdf/vtkhdf_mesh_reader.h"

#include <algorithm>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/packed.h"
#include "framework/geometry/packed_mesh.h"
#include "plugins/vtkhdf/isolated.h"
#include "plugins/vtkhdf/vtkhdf_reader.h"

namespace weir {

namespace {

TriangleMesh readLast(const std::filesystem::path& file) {
  const VtkHdfReader reader(file);
  VtkHdfStep step = reader.readLast();
  TriangleMesh mesh{.vertices = std::move(step.positions),
                    .triangles = reader.triangles(reader.times().size() - 1)};
  if (mesh.empty())
    throw ioError("the last step holds no triangles", "what --export-surface wrote",
                  "ParticleFile reads what --export wrote");
  return mesh;
}

}  // namespace

TriangleMesh VtkHdfMeshReader::read(const std::filesystem::path& file) const {
  try {
    return unpacked(hdf5::runIsolated([&] { return packed(readLast(file)); }, hdf5::cpuSecondsFor(file)));
  } catch (Error& error) {
    throw error.at({.file = file.string()});
  }
}

}  // namespace weir
