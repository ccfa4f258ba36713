// Videos that carry the scene which they show.
#pragma once

#include <filesystem>
#include <string_view>

namespace weir::studio {

/// Appends the scene, as JSON text behind the id "weir-scene-json1" in ASCII, to a complete video, where
/// programs pass over it: in .mp4 and .mov as a box "uuid" at the upper level (ISO/IEC 14496-12), in .mkv and
/// .webm as an element Void at the upper level (RFC 8794), in .gif as a comment. Throws an io Error if the
/// file cannot be written.
void carryScene(const std::filesystem::path& video, std::string_view scene);

}  // namespace weir::studio
