#include "apps/studio/session/carried_scene.h"

#include <cstdint>
#include <fstream>
#include <string>

#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir::studio {

namespace {

constexpr std::string_view kId = "weir-scene-json1";

std::string boxOf(std::string_view scene) {
  constexpr std::size_t kHead = 8;  // its size, the most significant byte first, and its type
  const std::size_t size = kHead + kId.size() + scene.size();
  std::string box;
  for (int shift = 24; shift >= 0; shift -= 8) box += static_cast<char>(size >> shift & 0xff);
  return box.append("uuid").append(kId).append(scene);
}

}  // namespace

void carryScene(const std::filesystem::path& video, std::string_view scene) {
  if (video.extension() != ".mp4" && video.extension() != ".mov") return;
  std::ofstream file(video, std::ios::binary | std::ios::app);
  file << boxOf(scene) << std::flush;
  if (!file) throw ioError("the scene cannot be written into " + inQuotes(video.string()));
}

}  // namespace weir::studio
