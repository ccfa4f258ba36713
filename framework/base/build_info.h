// Which Weir this is, and how it was built.
#pragma once

#include <string_view>

#include "framework/base/api.h"

namespace WEIR_API weir {

std::string_view version();       ///< "0.1.0"
std::string_view buildType();     ///< "Release"
std::string_view compilerName();  ///< "GNU 12.2.0"
/// "yes (NVIDIA 13.0.88, for 80;90)", or "no" with the reason.
std::string_view cudaBuildInfo();

}  // namespace weir
