// Single pictures as PNG files.
#pragma once

#include <filesystem>

#include "plugins/video/picture.h"

namespace weir::rendering {

/// Writes beside the path first, then renames: a reader finds the old file or the whole new one. 8 bits per
/// channel, sRGB, no loss; with opacity if the picture has it. Throws an io Error that names the file; what
/// stood at the path is then as before.
void writePng(const std::filesystem::path& path, const Picture& picture);

/// Throws an io Error that names the file if it is not there or no whole PNG.
Picture readPng(const std::filesystem::path& path);

}  // namespace weir::rendering
