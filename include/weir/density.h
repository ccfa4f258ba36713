// Densities, displacements and walls, for solvers.
#pragma once

#include "nodes/particle_fluid/density.h"
#include "nodes/particle_fluid/displacement.h"
#include "nodes/particle_fluid/wall_field.h"
