// Gives the node MeshFile the surfaces of VTKHDF files, such as those of --export-surface.
#pragma once

#include "nodes/mesh_file/mesh_reader.h"

namespace weir {

/// Reads the triangles of the last step, in a process of its own, as files come from anywhere; see
/// isolated.h.
class VtkHdfMeshReader final : public MeshReader {
 public:
  std::vector<std::string> extensions() const override { return {".vtkhdf"}; }
  TriangleMesh read(const std::filesystem::path& file) const override;
};

}  // namespace weir
