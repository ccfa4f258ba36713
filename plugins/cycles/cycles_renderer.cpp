#include "plugins/cycles/cycles_renderer.h"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

#include "framework/base/error.h"
#include "plugins/video/image_file.h"

namespace weir::rendering {

namespace fs = std::filesystem;

OwnFolder::OwnFolder() {
  std::error_code error;
  std::string pattern = (fs::temp_directory_path(error) / "weir-cycles-XXXXXX").string();
  if (error || ::mkdtemp(pattern.data()) == nullptr)
    throw ioError("no folder can be made for what is handed over to Blender: " +
                  (error ? error : std::error_code(errno, std::generic_category())).message())
        .at({.file = pattern});
  path_ = pattern;
}

OwnFolder::~OwnFolder() {
  std::error_code error;
  fs::remove_all(path_, error);
}

CyclesRenderer::CyclesRenderer(std::unique_ptr<Device> device, const CyclesSettings& settings,
                               double frameRate)
    : device_(std::move(device)), handover_(folder_.path(), settings, frameRate) {}

Picture CyclesRenderer::draw(const View& view) {
  if (interrupted_) return {};
  const fs::path frame = handover_.write(view), picture = folder_.path() / "picture.png";
  interrupted_ = !blender_.render(frame, picture);
  fs::remove(frame);
  if (interrupted_) return {};
  Picture result = readPng(picture);
  fs::remove(picture);
  return result;
}

}  // namespace weir::rendering
