// Solids of triangles that move, and how they come to particles.
#pragma once

#include "framework/solids/motion_of.h"
#include "framework/solids/solid.h"
#include "framework/solids/solid_coupling.h"
