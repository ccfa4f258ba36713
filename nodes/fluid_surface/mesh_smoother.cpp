#include "nodes/fluid_surface/mesh_smoother.h"

#include "framework/compute/dispatch.h"

namespace weir {

void MeshSmoother::smooth(Device& onDevice, DynamicMesh& mesh, int passes) {
  if (passes == 0 || mesh.empty()) return;
  dispatch(onDevice, [&](auto& device) { smoothOn(device, mesh, passes); });
}

}  // namespace weir
