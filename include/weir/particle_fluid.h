// The node ParticleFluid, for programs and tests that run it.
#pragma once

#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/particle_fluid.h"
