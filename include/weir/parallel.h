// Kernels and reductions, for one or eight elements at a time.
#pragma once

#include "framework/compute/atomics.h"
#include "framework/compute/dispatch.h"
#include "framework/compute/eight.h"
#include "framework/compute/parallel.h"
