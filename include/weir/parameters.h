// Parameters that describe themselves.
#pragma once

#include "framework/graph/configurable.h"
#include "framework/graph/keyframes.h"
#include "framework/graph/param_types.h"
