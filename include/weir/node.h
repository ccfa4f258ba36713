// Nodes: parameters, ports, steps, state and memory.
#pragma once

#include "framework/compute/dispatch.h"
#include "framework/graph/memory_estimate.h"
#include "framework/graph/node.h"
#include "framework/graph/setting_warning.h"
#include "framework/graph/state.h"
