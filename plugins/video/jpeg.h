// Pictures as JPEG files in memory, for those who watch a run: small, and quickly made.
#pragma once

#include <string>

#include "plugins/video/picture.h"

namespace weir::rendering {

/// `quality` is 1 to 100. The picture must be whole (WEIR_CHECK). Throws an io Error with libjpeg's reason.
std::string encodeJpeg(const Picture& picture, int quality = 85);

}  // namespace weir::rendering
