// Adds all nodes and modules of this library to a registry.
#pragma once

#include "framework/base/api.h"
#include "framework/graph/registry.h"

namespace WEIR_API weir {

void registerNodes(Registry& registry);

}  // namespace weir
