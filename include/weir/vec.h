// Vectors, boxes and rotations.
#pragma once

#include "framework/base/vec.h"
