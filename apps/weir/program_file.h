// Where the program itself is.
#pragma once

#include <filesystem>

namespace weir::app {

/// The file of the program that runs.
std::filesystem::path programFile();

}  // namespace weir::app
