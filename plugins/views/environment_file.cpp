#include "plugins/views/environment_file.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "framework/base/error.h"
#include "framework/scene/scene_file.h"

#ifdef WEIR_HAS_STB
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop
#endif

namespace weir::rendering {

namespace fs = std::filesystem;

#ifdef WEIR_HAS_STB

namespace {

constexpr std::size_t kLargestFile = std::size_t{512} << 20;  // bytes
constexpr int kWidest = 8192;

Error wrong(const fs::path& file, const std::string& what, const std::string& allowed) {
  return ioError(what, allowed).at({.file = file.string()});
}

/// The bytes behind the head: an empty line ends its words, and a line with the size is the last.
std::string_view pixelsOf(std::string_view bytes) {
  const std::size_t words = bytes.find("\n\n");
  const std::size_t size = words == std::string_view::npos ? words : bytes.find('\n', words + 2);
  return size == std::string_view::npos ? std::string_view() : bytes.substr(size + 1);
}

/// Takes the runs of one line of one channel; false if they end too early.
bool takeRuns(std::string_view& rest, int width) {
  constexpr int kLongest = 128;  // of numbers that differ; above that it counts equal ones
  for (int x = 0; x < width;) {
    if (rest.empty()) return false;
    const int count = static_cast<unsigned char>(rest.front());
    const bool equal = count > kLongest;
    const std::size_t bytes = 1 + static_cast<std::size_t>(equal ? 1 : count);
    if (rest.size() < bytes) return false;
    rest.remove_prefix(bytes);
    x += equal ? count - kLongest : count;
  }
  return true;
}

/// Whether all pixels are there. The library takes missing ones for black.
bool isWhole(std::string_view rest, int width, int height) {
  constexpr int kNarrowest = 8, kTooWide = 32768;  // of lines that may be run lengths
  const auto isRuns = [&] {
    return width >= kNarrowest && width < kTooWide && rest.size() >= 4 && rest[0] == 2 && rest[1] == 2 &&
           (rest[2] & 0x80) == 0;
  };
  if (!isRuns())
    return rest.size() >= std::size_t{4} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (int y = 0; y < height; ++y) {
    if (!isRuns()) return false;
    rest.remove_prefix(4);
    for (int channel = 0; channel < 4; ++channel)
      if (!takeRuns(rest, width)) return false;
  }
  return true;
}

}  // namespace

std::shared_ptr<const EnvironmentImage> readEnvironment(const fs::path& file, float turn, float brightness) {
  const std::string bytes = readTextFile(file, kLargestFile);
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_is_hdr_from_memory(data, size) == 0)
    throw wrong(file, "this is not a Radiance picture",
                "a file that begins with #?RADIANCE, as .hdr files do");
  if (stbi_info_from_memory(data, size, &width, &height, &channels) == 0)
    throw wrong(file, "the Radiance picture has a damaged head", "a whole .hdr file");
  if (width != 2 * height || width > kWidest)
    throw wrong(file,
                "the surroundings are " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
                "twice as wide as high, as a picture of all directions is, and at most " +
                    std::to_string(kWidest) + " wide");
  if (!isWhole(pixelsOf(bytes), width, height))
    throw wrong(file, "the Radiance picture ends before its last pixel", "a whole .hdr file");
  const std::unique_ptr<float, void (*)(void*)> pixels(
      stbi_loadf_from_memory(data, size, &width, &height, &channels, 3), stbi_image_free);
  if (!pixels)
    throw wrong(file, std::string("the Radiance picture cannot be read: ") + stbi_failure_reason(),
                "a whole .hdr file");
  auto image = std::make_shared<EnvironmentImage>();
  image->width = width, image->height = height;
  image->light.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto turned =
      static_cast<int>(std::lround(std::fmod(turn, 360.0f) / 360 * static_cast<float>(width)));
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      // Seen from within, columns go the other way round, and half a turn on.
      const int from = ((3 * width / 2 - 1 - column + turned) % width + width) % width;
      const float* pixel = pixels.get() + 3 * (static_cast<std::ptrdiff_t>(height - 1 - row) * width + from);
      image->light[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(column)] = Vec3f{pixel[0], pixel[1], pixel[2]} * brightness;
    }
  findAmbient(*image);
  return image;
}

#else

std::shared_ptr<const EnvironmentImage> readEnvironment(const fs::path& file, float, float) {
  throw ioError("surroundings cannot be read from a picture: Weir was built without stb_image", "no image",
                "build it with stb_image.h (Debian and Ubuntu: libstb-dev)")
      .at({.file = file.string()});
}

#endif

}  // namespace weir::rendering
