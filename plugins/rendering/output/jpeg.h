// Pictures as JPEG files in memory, for those who watch a run: small, and quickly made.
#pragma once

#include <string>

#include "plugins/rendering/output/picture.h"

namespace weir::rendering {

/// A baseline JPEG file (ITU-T T.81) with colours at half the resolution. `quality` is 1 to 100, in the usual
/// scale of the tables of its annex K. The picture must be whole and at most 65535 pixels a side
/// (WEIR_CHECK).
std::string encodeJpeg(const Picture& picture, int quality = 85);

}  // namespace weir::rendering
