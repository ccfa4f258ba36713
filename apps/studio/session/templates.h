// The scenes that come with Weir, to start from.
#pragma once

#include <filesystem>
#include <string>

#include "framework/base/value.h"

namespace weir::studio {

/// [{"path", "title", "description", "group", "types", "bytes", "thumbnail"}] of the scenes that
/// templates/index.json in the folder lists, or without such a file, of those in the folder. What cannot be
/// read is left out. `thumbnail` is an address, "" if there is none.
Value templatesIn(const std::filesystem::path& folder);

/// Where the thumbnail of this file name lies: templates/NAME in the folder of scenes. Throws a usage Error
/// for a name that leads elsewhere.
std::filesystem::path thumbnailFile(const std::filesystem::path& folder, const std::string& name);

}  // namespace weir::studio
