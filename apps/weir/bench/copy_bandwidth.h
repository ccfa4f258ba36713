// What the memory of a device can do: the measure for how well a step uses it.
#pragma once

#include "framework/compute/device.h"

namespace weir::app {

/// Bytes a second, read and written together, of a copy of 256 MiB within the device's memory; the best of
/// several. On the CPU all of its threads copy. Needs twice that much memory, or throws as allocate() does.
double copyBandwidth(Device& device);

}  // namespace weir::app
