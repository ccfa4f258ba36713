// Reads meshes through Assimp.
#pragma once

#include "nodes/mesh_file/mesh_reader.h"

namespace weir {

class AssimpReader final : public MeshReader {
 public:
  std::vector<std::string> extensions() const override;
  TriangleMesh read(const std::filesystem::path& file) const override;
};

}  // namespace weir
