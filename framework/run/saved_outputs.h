// What outputs have on the disk when a checkpoint is made.
#pragma once

#include <span>

#include "framework/base/api.h"
#include "framework/graph/state.h"
#include "framework/run/observer.h"

namespace WEIR_API weir {

/// What observers have goes to the disk, and their states to `to`. All that they captured has been written.
void saveOutputs(std::span<Observer* const> observers, const StateWriter& to);

}  // namespace weir
