// The surface on which a field on a sparse grid has a given value, as a mesh (marching cubes; Lorensen and
// Cline 1987).
//
// A vertex stands on each edge of the grid that leads from inside (above the value) to outside, where the
// field is the value if it is linear along the edge; it is shared by all triangles that meet there.
// CubeTable says why the mesh is closed. Vertices keep a hundredth of an edge away from its ends, so no
// triangle is without area.
#pragma once

#include "framework/base/api.h"
#include "framework/geometry/dynamic_mesh.h"
#include "nodes/fluid_surface/cube_table.h"
#include "nodes/fluid_surface/sparse_grid.h"

namespace WEIR_API weir {

class MarchingCubes {
 public:
  explicit MarchingCubes(Device& device);

  /// Puts the mesh into `mesh`, with vertices and triangles in the order of the blocks and nodes. Normals go
  /// down the field's gradient, by central differences at both ends of an edge. `level` is above 0, and a
  /// cell with a corner above it must have a block. Throws a simulation Error if there are too many vertices
  /// to count. Waits for the device.
  void extract(Device& device, const SparseGrid& grid, float level, DynamicMesh& mesh);

 private:
  template <class Backend>
  void countOn(Backend& device, const SparseGrid& grid, float level);
  template <class Backend>
  void placeOn(Backend& device, const SparseGrid& grid, float level, DynamicMesh& mesh);

  Array<CubeTable> table_;
  Array<int> vertices_, triangles_;  // of each node: how many it owns, then the number of its first
  Array<int> totals_;                // of both
};

}  // namespace weir
