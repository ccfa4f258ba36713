// Outputs of a run: observers, their options, checkpoints.
#pragma once

#include "framework/graph/outputs_of.h"
#include "framework/run/checkpoint.h"
#include "framework/run/observer.h"
#include "framework/run/output_kind.h"
