// Walls by signed distance.
#pragma once

#include "nodes/static_boundary/boundary.h"
