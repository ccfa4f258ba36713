// Copies to host memory beside the simulation.
#pragma once

#include "framework/compute/host_copy.h"
