// The solids of a boundary as Python asks them: by signed distance, on the host.
#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <vector>

#include "framework/compute/device.h"
#include "nodes/static_boundary/boundary.h"
#include "python/src/python_scene.h"

namespace weir::python {

namespace nb = nanobind;

class Walls {
 public:
  /// Meshes of a GPU are copied; of a CPU they are shared.
  Walls(std::shared_ptr<Device> device, const Boundary& boundary);
  Walls(const Walls&) = delete;
  Walls& operator=(const Walls&) = delete;
  Walls(Walls&&) = default;

  /// Of points (n, 3) in m: the distances (n,) to the nearest solid in m, negative in it, and the unit
  /// normals (n, 3) out of it. Without solids, everything is 1e30 m away.
  nb::tuple query(nb::handle points) const;

 private:
  struct HostGrid {
    std::vector<float> coarse, nodes;
    std::vector<int> brickIndex;
  };
  /// Lets the view point to a copy of what it points to.
  void copyToHost(MeshSdfView& mesh);

  std::shared_ptr<Device> device_;  // first, as meshes stand in its memory
  std::vector<std::shared_ptr<const MeshSdf>> meshes_;
  std::vector<std::unique_ptr<HostGrid>> grids_;
  std::vector<BoundaryPiece> pieces_;
};

/// Of an output of the type Boundary. Throws a usage Error before a simulation.
Walls wallsOf(const PythonScene& scene, const std::string& node, const std::string& output);

void bindWalls(nb::module_& m);

}  // namespace weir::python
