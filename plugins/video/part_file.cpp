#include "plugins/video/part_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

std::string reasonOf(int error) {
  return std::generic_category().message(error);
}

void checkTarget(const fs::path& target) {
  std::error_code ignored;
  if (fs::is_directory(target, ignored)) throw cannotWrite(target, "it is a folder");
  // A device or a pipe is not a file that could be replaced.
  if (fs::exists(target, ignored) && !fs::is_regular_file(target, ignored))
    throw cannotWrite(target, "it is not a regular file");
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!fs::exists(folder, ignored))
    throw cannotWrite(target, "there is no folder " + folder.string(), "make the folder first");
}

/// "run.part.mp4", "run.part2.mp4"
fs::path nameBeside(const fs::path& target, int number) {
  fs::path path = target;
  path.replace_extension();
  path += ".part" + (number > 1 ? std::to_string(number) : std::string());
  path += target.extension();
  return path;
}

/// Makes a new file; its name is returned.
fs::path makeBeside(const fs::path& target) {
  constexpr int kMaxTries = 1000;
  constexpr mode_t kReadWriteForAll = 0666;  // less what the process masks
  for (int i = 1; i <= kMaxTries; ++i) {
    const fs::path path = nameBeside(target, i);
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kReadWriteForAll);
    if (file >= 0) {
      ::close(file);
      return path;
    }
    if (errno != EEXIST) throw cannotWrite(target, reasonOf(errno));
  }
  throw cannotWrite(target, "there are too many unfinished files beside it",
                    "remove the files with .part in their name that no program is writing");
}

bool writeAll(int file, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

Error cannotWrite(const fs::path& file, const std::string& reason, const std::string& hint) {
  return ioError("the file cannot be written: " + reason, {}, hint).at({.file = file.string()});
}

void PartFile::removeLeft(const fs::path& target) {
  std::error_code ignored;
  for (int i = 1; fs::remove(nameBeside(target, i), ignored); ++i) {
  }
}

PartFile::PartFile(fs::path target, PartPlace place) : target_(std::move(target)) {
  checkTarget(target_);
  path_ = place == PartPlace::kAppended ? target_ : makeBeside(target_);
  std::error_code error;
  begin_ = fs::file_size(path_, error);
  if (error) throw cannotWrite(target_, error.message());
}

PartFile::~PartFile() {
  std::error_code ignored;
  if (kept_) return;
  if (path_ == target_)
    fs::resize_file(path_, begin_, ignored);
  else
    fs::remove(path_, ignored);
}

void PartFile::write(std::span<const std::uint8_t> bytes) {
  const int file = ::open(path_.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  if (file < 0) throw cannotWrite(target_, reasonOf(errno));
  const int writeError = writeAll(file, bytes) ? 0 : errno;
  // Network file systems may notice only here that the disk is full.
  const int closeError = ::close(file) == 0 ? 0 : errno;
  if (writeError != 0) throw cannotWrite(target_, reasonOf(writeError));
  if (closeError != 0) throw cannotWrite(target_, reasonOf(closeError));
}

void PartFile::keep() {
  if (path_ != target_ && ::rename(path_.c_str(), target_.c_str()) != 0)
    throw cannotWrite(target_, reasonOf(errno));
  kept_ = true;
}

}  // namespace weir::rendering
