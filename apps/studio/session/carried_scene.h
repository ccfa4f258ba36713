// Videos that carry the scene which they show.
#pragma once

#include <filesystem>
#include <string_view>

namespace weir::studio {

/// Appends the scene, as JSON text, to a complete video as a box of type "uuid" at the upper level (ISO/IEC
/// 14496-12), with the id "weir-scene-json1" in ASCII; programs pass over it. Only files named .mp4 or .mov
/// consist of such boxes: others stay as they are. Throws an io Error if the file cannot be written.
void carryScene(const std::filesystem::path& video, std::string_view scene);

}  // namespace weir::studio
