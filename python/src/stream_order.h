// The order of a device's work and that of other libraries on the same GPU. On the CPU there is nothing to
// do.
#pragma once

#include <cstdint>

#include "framework/compute/device.h"

namespace weir::python {

/// CUDA's streams as numbers: handles, or these.
inline constexpr std::uintptr_t kLegacyStream = 1, kPerThreadStream = 2;

/// The device's own stream, or 0 on the CPU. All that it was asked for so far has been issued to it.
std::uintptr_t streamOf(const Device& device);

/// What is put into the stream from now on begins when the device has done what it was asked for so far.
void letStreamWait(const Device& device, std::uintptr_t stream);

/// What the device is asked for from now on begins when all is done that stands in the stream.
void waitForStream(const Device& device, std::uintptr_t stream);

}  // namespace weir::python
