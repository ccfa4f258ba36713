// weir info FILE: what a file holds, and whether all of it can be read.
#pragma once

#include <string>
#include <vector>

#include "apps/weir/program.h"

namespace weir::app {

/// Prints what each file holds, or its scene alone. Returns the exit code of the first that cannot be read.
int describeFiles(Program& program, const std::vector<std::string>& files, bool sceneOnly);

}  // namespace weir::app
