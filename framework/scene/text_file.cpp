#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

#include "framework/base/text.h"
#include "framework/scene/scene_file.h"

namespace weir {

namespace {

Error cannotRead(const std::filesystem::path& path, const std::string& reason, const std::string& hint = {}) {
  Error error = ioError("the file cannot be read: " + reason, {}, hint);
  return error.at({.file = path.string()});
}

}  // namespace

std::string readTextFile(const std::filesystem::path& path, std::size_t largest) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw cannotRead(path, "it is a folder");
  const auto close = [](std::FILE* f) { std::fclose(f); };
  const std::unique_ptr<std::FILE, decltype(close)> file(std::fopen(path.c_str(), "rb"), close);
  if (file == nullptr) {
    const int error = errno;
    const bool missing = error == ENOENT && path.is_relative();
    const std::string folder = std::filesystem::current_path(ignored).string();
    throw cannotRead(path, std::generic_category().message(error),
                     missing ? "the current folder is " + folder : "");
  }
  std::string text;
  char block[1 << 16];
  for (std::size_t got = sizeof block; got == sizeof block;) {
    got = std::fread(block, 1, sizeof block, file.get());
    text.append(block, got);
    if (text.size() > largest)
      throw cannotRead(path, fmt::format("it is larger than {} bytes", largest),
                       "large data belongs into files of its own, which the scene names");
  }
  if (std::ferror(file.get()) != 0) throw cannotRead(path, std::generic_category().message(errno));
  return text;
}

}  // namespace weir
