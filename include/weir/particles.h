// Particles with their attributes, and batches of new ones.
#pragma once

#include "framework/particles/particle_batch.h"
#include "framework/particles/particle_set.h"
