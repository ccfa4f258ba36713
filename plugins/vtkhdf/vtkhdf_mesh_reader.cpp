#include "plugins/vtkhdf/vtkhdf_mesh_reader.h"

#include <algorithm>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/packed.h"
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

std::string packed(const TriangleMesh& mesh) {
  Packer packer;
  packer.addAll(mesh.vertices);
  packer.addAll(mesh.triangles);
  return packer.take();
}

/// Believes nothing, as a damaged file may have upset the process that packed it.
TriangleMesh unpacked(std::string_view bytes) {
  Unpacker unpacker(bytes);
  TriangleMesh mesh{.vertices = unpacker.all<Vec3f>(), .triangles = unpacker.all<Vec3i>()};
  const auto count = static_cast<std::int64_t>(mesh.vertices.size());
  const auto there = [&](int vertex) { return vertex >= 0 && vertex < count; };
  const bool good = std::all_of(mesh.triangles.begin(), mesh.triangles.end(),
                                [&](const Vec3i& t) { return there(t.x) && there(t.y) && there(t.z); });
  if (!good) throw ioError("the file is damaged: its contents are inconsistent");
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
