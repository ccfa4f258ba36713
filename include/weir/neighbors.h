// Neighbours, and sums over them.
#pragma once

#include "framework/compute/dispatch.h"
#include "framework/neighbors/neighbor_list.h"
#include "framework/neighbors/neighbor_sum.h"
