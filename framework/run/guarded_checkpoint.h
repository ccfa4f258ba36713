// Checkpoints that plugins keep: whatever they throw becomes an Error that names store, hook and plugin.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "framework/base/api.h"
#include "framework/communication/communicator.h"
#include "framework/graph/registry.h"
#include "framework/run/checkpoint.h"

namespace WEIR_API weir {

/// All that keep checkpoints, by name; each of their functions is guarded. An Error that names a file passes
/// as it is: it says enough.
std::vector<std::unique_ptr<CheckpointStore>> guardedCheckpointStores(const Registry& registry);

/// The one that keeps files that end like this one. Throws a usage Error that begins with `option`, such as
/// "--resume state.h5", if there is none.
std::unique_ptr<CheckpointStore> checkpointStoreOf(const Registry& registry, const std::string& option,
                                                   const std::filesystem::path& file);

/// What the file holds, with its parts; of these, on several ranks, the share of this one. Throws an io Error
/// that names the file if it does not belong to the simulation, or a part is not what it was.
Checkpoint readCheckpoint(const CheckpointStore& store, const std::filesystem::path& file,
                          const Simulation& simulation, const Communicator* ranks = nullptr);

/// The same for the newest checkpoint that is whole: what stands at the path, or else the one before it, or
/// none. All ranks, which call this together, take the same. The log is told which, and what is wrong with
/// those that are not whole. Throws as readCheckpoint for one that does not belong to the simulation, and an
/// io Error for one that may not be read.
std::optional<Checkpoint> readNewestCheckpoint(const CheckpointStore& store,
                                               const std::filesystem::path& file,
                                               const Simulation& simulation, Communicator* ranks = nullptr);

}  // namespace weir
