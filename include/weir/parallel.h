// Kernels and reductions, for one or eight elements at a time.
#pragma once

#include "framework/compute/atomic_add.h"
#include "framework/compute/atomic_min.h"
#include "framework/compute/eight.h"
#include "framework/compute/parallel.h"
