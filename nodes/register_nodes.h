// Adds all nodes and modules of this library to a registry.
#pragma once

#include "framework/graph/registry.h"

namespace weir {

void registerNodes(Registry& registry);

}  // namespace weir
