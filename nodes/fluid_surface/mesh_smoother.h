// Smooths closed meshes on the device without shrinking them (Taubin 1995, "A signal processing approach to
// fair surface design").
//
// With n_i the mean of the vertices that share an edge with vertex i, each pass moves all vertices twice:
// x_i ← x_i + 0.5·(n_i − x_i), then x_i ← x_i − 0.53·(n_i − x_i).
#pragma once

#include "framework/compute/cell_sort.h"
#include "framework/geometry/dynamic_mesh.h"

namespace weir {

class MeshSmoother {
 public:
  explicit MeshSmoother(Device& device) : corners_(device), kept_(device, 1), moved_(device) {}

  /// The mesh must be closed: each edge of a triangle is an edge of another one, the other way round. Normals
  /// become those of the triangles around each vertex, weighted by area. Nothing happens for 0 passes.
  void smooth(Device& device, DynamicMesh& mesh, int passes);

 private:
  template <class Backend>
  void smoothOn(Backend& device, DynamicMesh& mesh, int passes);

  CellSort corners_;  // of the triangles, by vertex
  Array<int> kept_;
  Array<Vec3f> moved_;
};

}  // namespace weir
