// Particles with their attributes, what nodes with particles put out, and batches of new ones.
#pragma once

#include "framework/compute/dispatch.h"
#include "framework/particles/particle_batch.h"
#include "framework/particles/particle_set.h"
#include "framework/particles/particles.h"
