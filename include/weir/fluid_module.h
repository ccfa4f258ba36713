// Modules of a fluid.
#pragma once

#include "nodes/particle_fluid/fluid_module.h"
