// Scenes that give a module parameters which another type has now (graph/moved_parameters.h).
#pragma once

#include <string>
#include <vector>

#include "framework/base/api.h"
#include "framework/graph/module.h"
#include "framework/graph/place.h"
#include "framework/graph/registry.h"

namespace WEIR_API weir {

/// The "modules" object of a node in the words of today. Adds a warning, which says what to write, for each
/// module whose parameters it changes. A module without a "type" gets one where the pipeline's default has
/// taken the place of the type that knows its parameters.
Value withMovedParameters(Value modules, const PipelineBase& pipeline, const Registry& registry,
                          const Place& place, std::vector<std::string>& warnings);

}  // namespace weir
