// Colour maps in files: tables as CSV, and the JSON presets of ParaView.
#pragma once

#include <filesystem>
#include <vector>

#include "framework/base/vec.h"

namespace weir::rendering {

/// The colours of a file, evenly spread from low to high values: two or more, sRGB components in [0, 1].
///
/// A .csv file has red, green and blue in each line, or a value before them; values grow from line to line
/// and need not be evenly spread. Components are in [0, 1], or, if any is above 1, all are in [0, 255]. A
/// first line of words is passed over, and so are empty lines and those that begin with #. A .json file is a
/// list of ParaView's presets, of which the first one's "RGBPoints" are taken. Throws an io Error that says
/// where the file is wrong.
std::vector<Vec3f> readColorFile(const std::filesystem::path& file);

}  // namespace weir::rendering
