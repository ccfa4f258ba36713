// What node and module types say of themselves, as data: for `weir nodes --json`, documentation and other
// languages.
#pragma once

#include "framework/base/api.h"
#include "framework/graph/registry.h"

namespace WEIR_API weir {

/// A list of objects: name, kind, unit, doc, also (other words for it), default, min or above, max, soft_min,
/// soft_max, only_for {parameter, choices}, live, animated, choices {name: doc} of an enum, and parameters of
/// a group. What is not said is left out.
Value parametersAsValue(const Configurable& owner);

/// doc, also, source, inputs and outputs [{name, type, doc, …}], parameters, and for a node with a pipeline
/// family and modules [{name, type, enabled}].
Value typeAsValue(const Registry& registry, const Registry::NodeType& type);
/// doc, also, source, family, parameters.
Value typeAsValue(const Registry& registry, const Registry::ModuleType& type);

}  // namespace weir
