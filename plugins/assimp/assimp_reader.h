// Reads meshes through Assimp, whose readers crash, hang or take all memory on some damaged files: in a copy
// of the process, with limits of time and memory, and with no files but those in the mesh's folder.
//
// Seven endings unasked; WEIR_MESH_FORMATS=all in the environment has all that Assimp reads.
// WEIR_MESH_MEMORY_MB and WEIR_MESH_SECONDS set the limits.
#pragma once

#include "nodes/mesh_file/mesh_reader.h"

namespace weir {

class AssimpReader final : public MeshReader {
 public:
  std::vector<std::string> extensions() const override;
  std::string hintFor(const std::string& extension) const override;
  TriangleMesh read(const std::filesystem::path& file) const override;
};

}  // namespace weir
