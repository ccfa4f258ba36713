#include "plugins/video/image_file.h"

#include <png.h>

#include <string>
#include <utility>
#include <vector>

#include "framework/base/check.h"
#include "plugins/video/part_file.h"

namespace weir::rendering {

namespace {

/// The bytes of a PNG file.
std::vector<std::uint8_t> encodePng(const std::filesystem::path& path, const Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  const bool opaque = picture.alpha.empty();
  image.format = opaque ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  const std::vector<std::uint8_t> rgba = opaque ? std::vector<std::uint8_t>() : picture.rgba();
  const std::uint8_t* pixels = opaque ? picture.rgb.data() : rgba.data();
  // Four times as fast, for files that are a tenth to a fifth larger.
  image.flags = PNG_IMAGE_FLAG_FAST;
  std::vector<std::uint8_t> bytes(PNG_IMAGE_PNG_SIZE_MAX(image));
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels, 0, nullptr) == 0)
    throw cannotWrite(path, "libpng says: " + std::string(image.message));
  bytes.resize(size);
  return bytes;
}

}  // namespace

void writePng(const std::filesystem::path& path, const Picture& picture) {
  WEIR_CHECK(picture.isWhole());
  PartFile file(path);
  file.write(encodePng(path, picture));
  file.keep();
}

Picture readPng(const std::filesystem::path& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  const auto failed = [&] {
    const std::string reason = image.message;
    png_image_free(&image);
    return ioError("the picture cannot be read: libpng says: " + reason).at({.file = path.string()});
  };
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0) throw failed();
  const bool opaque = (image.format & PNG_FORMAT_FLAG_ALPHA) == 0;
  image.format = opaque ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(image));
  if (png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr) == 0) throw failed();
  Picture picture{static_cast<int>(image.width), static_cast<int>(image.height), {}};
  if (opaque) {
    picture.rgb = std::move(bytes);
    return picture;
  }
  for (std::size_t i = 0; i < bytes.size(); i += 4) {
    picture.rgb.insert(picture.rgb.end(), {bytes[i], bytes[i + 1], bytes[i + 2]});
    picture.alpha.push_back(bytes[i + 3]);
  }
  return picture;
}

}  // namespace weir::rendering
