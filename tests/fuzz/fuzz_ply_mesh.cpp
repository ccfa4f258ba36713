// PLY files of meshes.
#include "nodes/mesh_file/ply_mesh_reader.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return weir::fuzz::withFile(data, size, ".ply", [](const std::string& file) {
    const weir::TriangleMesh mesh = weir::PlyMeshReader().read(file);
    for (const weir::Vec3i& triangle : mesh.triangles)
      for (int k = 0; k < 3; ++k)
        if (static_cast<std::size_t>(triangle[k]) >= mesh.vertices.size()) std::abort();
  });
}
