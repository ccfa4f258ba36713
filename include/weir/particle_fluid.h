// The fluid: what it puts out.
#pragma once

#include "nodes/particle_fluid/particle_fluid.h"
