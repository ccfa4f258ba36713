// How many GPUs there are, without opening them.
#pragma once

#include "framework/base/api.h"

namespace WEIR_API weir {

/// That this process may use; 0 in builds without CUDA.
int cudaDeviceCount();

}  // namespace weir
