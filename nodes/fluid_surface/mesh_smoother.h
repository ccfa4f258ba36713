// Smooths closed meshes on the device without shrinking them.
//
// With n_i the mean of the vertices that share an edge with vertex i, N passes of x_i ← x_i + 2/3·(n_i − x_i)
// give y_i. They take waves away, and volume as well: what a vertex has lost along its normal,
// b_i = N_i·(x_i − y_i), is spread by the same N passes, and given back,
//
//   x_i ← y_i + b̄_i·N_i.
//
// A wave to which N passes leave the share p has 1 − (1 − p)² left of its height: half of it is gone for one
// of about 3.3·√N edges, and long ones stay. As b̄ is the same all over what is smaller than that, drops and
// threads stay what they are. The volume is given back as by J. Vollmer, R. Mencl, H. Müller 1999 ("Improved
// Laplacian smoothing of noisy surface meshes"), but along normals and over as many vertices as it came from.
#pragma once

#include "framework/compute/cell_sort.h"
#include "framework/geometry/dynamic_mesh.h"

namespace weir {

class MeshSmoother {
 public:
  explicit MeshSmoother(Device& device)
      : corners_(device),
        kept_(device, 1),
        moved_{Array<Vec3f>(device), Array<Vec3f>(device)},
        lost_{Array<float>(device), Array<float>(device)} {}

  /// The mesh must be closed: each edge of a triangle is an edge of another one, the other way round. Normals
  /// become those of the triangles around each vertex, weighted by area. Nothing happens for 0 passes.
  void smooth(Device& device, DynamicMesh& mesh, int passes);

 private:
  template <class Backend>
  void smoothOn(Backend& device, DynamicMesh& mesh, int passes);
  /// Values of the vertices after so many passes; each leaves its own in room[pass % 2].
  template <class Backend, class T>
  ArrayView<const T> spread(Backend& device, ArrayView<const Vec3i> triangles, int passes,
                            ArrayView<const T> values, Array<T> (&room)[2]);

  CellSort corners_;  // of the triangles, by vertex
  Array<int> kept_;
  Array<Vec3f> moved_[2];
  Array<float> lost_[2];
};

}  // namespace weir
