// Checks of the paths that a run shall write to, before any time is spent on it.
#pragma once

#include <filesystem>
#include <string>

#include "framework/base/api.h"
#include "framework/run/output_kind.h"

namespace WEIR_API weir {

/// Throws a usage Error if a file ends in anything but what the option allows, and an io Error if the folder
/// that it shall be in does not exist. `what` names the option and its value in messages.
void checkOutputPath(const OutputOption& option, const std::filesystem::path& path, const std::string& what);

}  // namespace weir
