// Readers of mesh files. Plugins bring them as services, so that no node knows an import library:
//
//   registry.addService<MeshReader>("assimp", [] { return std::make_unique<AssimpReader>(); });
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/geometry/triangle_mesh.h"

namespace WEIR_API weir {

class MeshReader {
 public:
  static constexpr std::string_view kInterface = "MeshReader";
  virtual ~MeshReader() = default;

  /// The endings of files that it reads, lower case with the dot: ".obj".
  virtual std::vector<std::string> extensions() const = 0;
  /// What a user can do to have files of another ending read; "" where there is nothing.
  virtual std::string hintFor(const std::string& /*extension*/) const { return {}; }
  /// All triangles of the file with the transforms of its scene, in the file's units, as they stand there:
  /// neither welded nor cleaned; larger polygons are triangulated, points and lines left out. Throws an io
  /// Error that names the file.
  virtual TriangleMesh read(const std::filesystem::path& file) const = 0;
};

}  // namespace weir
