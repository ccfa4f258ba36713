#include "plugins/video/jpeg.h"

#include <csetjmp>
#include <cstdio>  // before jpeglib.h, which needs it
#include <cstdlib>
#include <memory>

#include <jpeglib.h>

#include "framework/base/check.h"
#include "framework/base/error.h"

namespace weir::rendering {

namespace {

/// How libjpeg's errors leave it: by a jump, as it is C and nothing may be thrown through it.
struct Failure {
  jpeg_error_mgr manager;  // first: libjpeg knows this part only
  std::jmp_buf place;
  char message[JMSG_LENGTH_MAX];
};

void leave(j_common_ptr info) {
  auto* failure = reinterpret_cast<Failure*>(info->err);
  failure->manager.format_message(info, failure->message);
  std::longjmp(failure->place, 1);
}

/// Returns false with the reason in `failure`. Has nothing that must be destroyed, as it may be left by a
/// jump.
bool compress(const Picture& picture, int quality, Failure& failure, unsigned char*& bytes,
              unsigned long& size) {
  jpeg_compress_struct info;
  info.err = jpeg_std_error(&failure.manager);
  failure.manager.error_exit = leave;
  if (setjmp(failure.place) != 0) {
    jpeg_destroy_compress(&info);
    return false;
  }
  jpeg_create_compress(&info);
  jpeg_mem_dest(&info, &bytes, &size);
  info.image_width = static_cast<JDIMENSION>(picture.width);
  info.image_height = static_cast<JDIMENSION>(picture.height);
  info.input_components = 3;
  info.in_color_space = JCS_RGB;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, quality, TRUE);
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    // It only reads the row, but does not say so.
    auto* row =
        const_cast<JSAMPLE*>(picture.rgb.data() + std::size_t{3} * info.image_width * info.next_scanline);
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  return true;
}

}  // namespace

std::string encodeJpeg(const Picture& picture, int quality) {
  constexpr int kMaxQuality = 100;
  WEIR_CHECK(picture.isWhole());
  WEIR_CHECK(quality >= 1);
  WEIR_CHECK(quality <= kMaxQuality);
  Failure failure{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const bool done = compress(picture, quality, failure, bytes, size);
  const std::unique_ptr<unsigned char, decltype(&std::free)> owner(bytes, &std::free);
  if (!done) throw ioError("the picture cannot be encoded: libjpeg says: " + std::string(failure.message));
  return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace weir::rendering
