// Devices, and arrays on them.
#pragma once

#include "framework/compute/array.h"
#include "framework/compute/device.h"
#include "framework/compute/dispatch.h"
