// Random numbers that a seed and an index decide.
#pragma once

#include "framework/base/random.h"
