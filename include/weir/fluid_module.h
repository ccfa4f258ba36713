// Modules of a fluid.
#pragma once

#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/fluid_module.h"
