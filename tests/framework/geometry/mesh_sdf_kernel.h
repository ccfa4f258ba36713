// Asks a grid of distances on a device.
#pragma once

#include "framework/compute/parallel.h"
#include "framework/geometry/mesh_sdf.h"

namespace weir::test {

/// out[i] = sdf.query(points[i])
template <class Backend>
void queryAll(Backend& device, const MeshSdfView& sdf, ArrayView<const Vec3f> points,
              ArrayView<SignedDistance> out);

}  // namespace weir::test
