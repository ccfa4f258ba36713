// Solids of triangles that move.
#pragma once

#include "framework/solids/motion_of.h"
#include "framework/solids/solid.h"
