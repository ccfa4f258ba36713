// What moves the mesh that a node puts out.
#pragma once

#include "framework/base/api.h"
#include "framework/graph/node.h"
#include "framework/solids/solid.h"

namespace WEIR_API weir {

/// The first node that takes the mesh and is a motion, or null if it is at rest. Plugins bring such nodes,
/// too.
inline const RigidMotion* motionOf(const OutputPort& mesh) {
  for (const InputPort* input : mesh.links())
    if (const auto* motion = dynamic_cast<const RigidMotion*>(&input->node())) return motion;
  return nullptr;
}

}  // namespace weir
