// The nodes that make solids, for programs that ask them for forces.
#pragma once

#include "nodes/semi_analytical_sfi/semi_analytical_sfi.h"
#include "nodes/static_boundary/static_boundary.h"
