// weir validate: checks scenes without running them.
#pragma once

#include <string>
#include <vector>

#include "apps/weir/program.h"

namespace weir::app {

/// Checks each scene and the files that it names, and prints "SCENE: valid" or the error. Returns the exit
/// code of the first that is not valid, or 0.
int validateScenes(Program& program, const std::vector<std::string>& scenes,
                   const std::vector<std::string>& overrides);

}  // namespace weir::app
