// Reads triangle meshes from PLY files, in all three encodings: x, y and z of the element "vertex", and the
// lists "vertex_indices" or "vertex_index" of the elements "face" and "tristrips". All else is passed over.
#pragma once

#include "framework/base/api.h"
#include "nodes/mesh_file/mesh_reader.h"

namespace WEIR_API weir {

class PlyMeshReader final : public MeshReader {
 public:
  std::vector<std::string> extensions() const override { return {".ply"}; }
  /// Errors name the line of the header or of ASCII data, or the row of binary data. A file that ends before
  /// or goes on behind what its header announces is an error, too.
  TriangleMesh read(const std::filesystem::path& file) const override;
};

}  // namespace weir
