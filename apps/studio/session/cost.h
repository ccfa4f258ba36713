// What a scene would cost to run, told before it is built.
#pragma once

#include <memory>

#include "framework/base/value.h"
#include "framework/compute/device.h"
#include "framework/scene/scene_file.h"

namespace weir::studio {

/// {"particles", "bytes", "available", "steps", "at_least", "fits"}: particles and bytes on the device at
/// most, see framework/graph/memory_estimate.h; bytes that are free there, 0 where nobody knows; steps of the
/// whole run, or with "at_least" those of the longest step. "fits": whether a reset would go beyond the check
/// of memory. Throws an Error if a node cannot tell what it needs.
Value costOf(std::unique_ptr<Scene> scene, Device& device, const Registry& registry);

}  // namespace weir::studio
