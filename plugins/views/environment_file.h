// Surroundings from a file.
#pragma once

#include <filesystem>
#include <memory>

#include "plugins/views/environment_image.h"

namespace weir::rendering {

/// Reads a Radiance picture (.hdr) of all directions: twice as wide as high, 8192 pixels wide at most. Its
/// middle is in the direction -z, with +x to its right, and is turned by `turn` degrees to its left, about y.
/// All light is multiplied by `brightness`. Throws an io Error that names the file.
std::shared_ptr<const EnvironmentImage> readEnvironment(const std::filesystem::path& file, float turn,
                                                        float brightness);

}  // namespace weir::rendering
