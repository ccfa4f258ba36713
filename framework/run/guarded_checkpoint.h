// Checkpoints that plugins keep: whatever they throw becomes an Error that names store, hook and plugin.
#pragma once

#include <memory>
#include <vector>

#include "framework/graph/registry.h"
#include "framework/run/checkpoint.h"

namespace weir {

/// All that keep checkpoints, by name; each of their functions is guarded. An Error that names a file passes
/// as it is: it says enough.
std::vector<std::unique_ptr<CheckpointStore>> guardedCheckpointStores(const Registry& registry);

}  // namespace weir
