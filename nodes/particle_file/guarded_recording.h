// Recordings that plugins open: whatever they throw becomes an Error that names reader, hook and plugin.
#pragma once

#include <memory>
#include <vector>

#include "framework/base/api.h"
#include "framework/graph/registry.h"
#include "nodes/particle_file/recording.h"

namespace WEIR_API weir {

/// All that open recordings, by name; their functions are guarded, and those of what they open. An Error that
/// names a file passes as it is: it says enough.
std::vector<std::unique_ptr<RecordingReader>> guardedRecordingReaders(const Registry& registry);

}  // namespace weir
