// What a plugin exports, and the registry that it fills.
#pragma once

#include "framework/graph/plugin.h"
#include "framework/graph/plugin_header.h"
#include "framework/graph/registry.h"
