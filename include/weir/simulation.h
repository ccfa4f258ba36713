// A simulation in your own program or test, from a scene file.
#pragma once

#include "framework/run/resume_check.h"
#include "framework/run/simulation.h"
#include "framework/scene/scene_file.h"
#include "nodes/register_nodes.h"
