#include "plugins/mesh_export/frame_files.h"

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/file_output.h"

namespace weir {

namespace fs = std::filesystem;

FrameFiles::FrameFiles(fs::path folder, std::string extension)
    : folder_(std::move(folder)), extension_(std::move(extension)) {
  std::error_code error;
  const auto refuse = [&](const std::string& reason) {
    return ioError("the folder cannot be used for " + extension_ + " files: " + reason)
        .at({.file = folder_.string()});
  };
  if (!fs::is_directory(folder_, error)) {
    if (fs::exists(folder_, error)) throw refuse("it is not a folder");
    fs::create_directory(folder_, error);
    if (error) throw refuse(error.message());
  }
  // Fails here rather than after hours of simulation.
  checkWritable(path("probe", 0));
}

fs::path FrameFiles::path(std::string_view thing, std::int64_t frame) const {
  return folder_ / fmt::format("{}_{:05}{}", thing, frame, extension_);
}

void FrameFiles::write(std::string_view thing, std::int64_t frame, std::string_view content) const {
  writeFileAtomically(path(thing, frame), content);
}

}  // namespace weir
