// Finds what all nodes of a scene put out, for those who show or export it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/graph/scene_graph.h"

namespace WEIR_API weir {

/// The outputs that carry T, with the names of their nodes, in the order of the nodes.
template <class T>
std::vector<std::pair<std::string, Output<T>*>> outputsOf(const SceneGraph& graph) {
  std::vector<std::pair<std::string, Output<T>*>> found;
  for (const auto& node : graph.nodes())
    for (OutputPort* output : node->outputs())
      if (output->typeName() == T::kPortType)
        found.emplace_back(node->name(), static_cast<Output<T>*>(output));
  return found;
}

}  // namespace weir
