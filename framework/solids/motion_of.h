// What moves the meshes that a node puts out.
#pragma once

#include <string>
#include <vector>

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

/// A mesh at one of the places where it is.
struct MovedMesh {
  std::string name;  ///< of the mesh's node; of what moves it, where that is one of several
  const RigidMotion* motion = nullptr;  ///< null if it is at rest
};

/// All that a mesh stands for: as many solids as there are nodes that move it, or one at rest.
inline std::vector<MovedMesh> movedMeshes(const OutputPort& mesh) {
  std::vector<MovedMesh> all;
  for (const InputPort* input : mesh.links())
    if (const auto* motion = dynamic_cast<const RigidMotion*>(&input->node()))
      all.push_back({input->node().name(), motion});
  if (all.size() > 1) return all;
  return {{mesh.node().name(), all.empty() ? nullptr : all.front().motion}};
}

}  // namespace weir
