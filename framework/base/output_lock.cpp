#include "framework/base/output_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir {

namespace fs = std::filesystem;

namespace {

std::string hostName() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "an unknown machine";
}

std::string readAll(int descriptor) {
  std::array<char, 512> text{};
  const ssize_t size = ::pread(descriptor, text.data(), text.size(), 0);
  return {text.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

Error isTaken(const fs::path& output, const std::string& holder) {
  return ioError(
             "another run writes there: " + (holder.empty() ? "who is not known" : printable(holder, 200)),
             "an output that no other run writes", "wait for it, end it, or choose another path")
      .at({.file = output.string()});
}

int openLock(const fs::path& file) {
  constexpr mode_t kReadWriteForAll = 0666;
  return ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kReadWriteForAll);
}

/// Whether the file is still what stands at the path: who had it before may have removed it.
bool standsAt(int descriptor, const fs::path& file) {
  struct stat opened {
  }, there{};
  return ::fstat(descriptor, &opened) == 0 && ::lstat(file.c_str(), &there) == 0 &&
         opened.st_dev == there.st_dev && opened.st_ino == there.st_ino;
}

}  // namespace

OutputLock::OutputLock(const fs::path& output) {
  // First of all: nothing removes the file of a lock whose constructor throws.
  const std::string self = fmt::format("process {} on {}", ::getpid(), hostName());
  fs::path path = fs::absolute(output).lexically_normal();
  if (path.filename().empty()) path = path.parent_path();
  std::error_code ignored;
  // A device or a pipe has no content that could be spoilt.
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored) && !fs::is_directory(path, ignored))
    return;
  while (descriptor_ < 0) {
    file_ = path.parent_path() / ("." + path.filename().string() + ".lock");
    int opened = openLock(file_);
    if (opened < 0 &&
        fs::is_directory(path, ignored)) {  // perhaps the folder may be written, but not the one above
      file_ = path / ".weir.lock";
      opened = openLock(file_);
    }
    if (opened < 0) return;  // then nothing can be written there either, which is told by who tries
    if (::flock(opened, LOCK_EX | LOCK_NB) != 0) {
      const bool taken = errno == EWOULDBLOCK;
      const std::string holder = readAll(opened);
      ::close(opened);
      if (taken) throw isTaken(output, holder);
      return;
    }
    if (standsAt(opened, file_))
      descriptor_ = opened;
    else
      ::close(opened);
  }
  // For messages only: on a full disk there is none.
  if (::ftruncate(descriptor_, 0) == 0) (void)!::pwrite(descriptor_, self.data(), self.size(), 0);
}

OutputLock::~OutputLock() {
  if (descriptor_ < 0) return;
  ::unlink(file_.c_str());  // before others can have it
  ::close(descriptor_);
}

OutputLock::OutputLock(OutputLock&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

}  // namespace weir
