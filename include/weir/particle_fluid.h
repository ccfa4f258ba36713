// The node ParticleFluid, for programs and tests that run it.
#pragma once

#include "nodes/particle_fluid/particle_fluid.h"
