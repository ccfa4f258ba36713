#include "nodes/fluid_surface/marching_cubes.h"

#include "framework/compute/dispatch.h"

namespace weir {

MarchingCubes::MarchingCubes(Device& device)
    : table_(device), vertices_(device), triangles_(device), totals_(device, 2) {
  const CubeTable table = makeCubeTable();
  table_.assign({&table, 1});
}

void MarchingCubes::extract(Device& onDevice, const SparseGrid& grid, float level, DynamicMesh& mesh) {
  WEIR_CHECK(level > 0);
  std::vector<int> totals{0, 0};
  if (grid.blocks() > 0) {
    // One more, so that the scan ends in the sum.
    const std::int64_t nodes = grid.blocks() * BlockKey::kNodes + 1;
    vertices_.resizeDiscarding(nodes);
    triangles_.resizeDiscarding(nodes);
    dispatch(onDevice, [&](auto& device) { countOn(device, grid, level); });
    totals = totals_.toHost();
  }
  mesh.vertices.resizeDiscarding(totals[0]);
  mesh.normals.resizeDiscarding(totals[0]);
  mesh.triangles.resizeDiscarding(totals[1]);
  if (totals[1] > 0) dispatch(onDevice, [&](auto& device) { placeOn(device, grid, level, mesh); });
}

}  // namespace weir
