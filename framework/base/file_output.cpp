#include "framework/base/file_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "framework/base/error.h"

namespace weir {

namespace fs = std::filesystem;

namespace {

Error cannotWrite(const fs::path& path, const std::string& reason, const std::string& hint = {}) {
  Error error = ioError("the file cannot be written: " + reason, {}, hint);
  return error.at({.file = path.string()});
}

Error cannotWrite(const fs::path& path, int error) {
  return cannotWrite(path, std::generic_category().message(error));
}

/// A new file beside the path; it is removed unless it was renamed to the path.
class Temporary {
 public:
  explicit Temporary(const fs::path& path) : path_(path) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) throw cannotWrite(path, "it is a folder");
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::exists(folder, ignored))
      throw cannotWrite(path, "there is no folder " + folder.string(), "make the folder first");
    // A device such as /dev/full or a pipe is not a file that could be replaced.
    if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
      throw cannotWrite(path, "it is not a regular file");
    // Opened with the usual permissions, which the process's umask narrows; mkstemp's would be the owner's
    // alone.
    constexpr int kMaxTries = 1000;
    constexpr mode_t kReadWriteForAll = 0666;
    for (int k = 0; file_ < 0 && k < kMaxTries; ++k) {
      name_ = (folder / fmt::format(".{}.{}.{}", path.filename().string(), ::getpid(), k)).string();
      file_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kReadWriteForAll);
      if (file_ < 0 && errno != EEXIST) break;
    }
    if (file_ < 0) throw cannotWrite(path, errno);
  }
  ~Temporary() {
    close();
    if (!renamed_) ::unlink(name_.c_str());
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  void write(std::string_view text) {
    while (!text.empty()) {
      const ssize_t written = ::write(file_, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) throw cannotWrite(path_, errno);
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  void setPermissions(fs::perms permissions) {
    if (::fchmod(file_, static_cast<mode_t>(permissions)) != 0) throw cannotWrite(path_, errno);
  }

  void rename() {
    if (::fsync(file_) != 0 && errno != EINVAL) throw cannotWrite(path_, errno);
    if (close() != 0) throw cannotWrite(path_, errno);
    if (::rename(name_.c_str(), path_.c_str()) != 0) throw cannotWrite(path_, errno);
    renamed_ = true;
    syncFolderOf(path_);
  }

 private:
  int close() {
    const int file = std::exchange(file_, -1);
    return file < 0 ? 0 : ::close(file);
  }

  fs::path path_;
  std::string name_;
  int file_ = -1;
  bool renamed_ = false;
};

}  // namespace

void syncFolderOf(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const int opened = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0 && errno == EACCES) return;  // a folder that may be written but not read cannot be opened
  const bool synced = opened >= 0 && (::fsync(opened) == 0 || errno == EINVAL);
  const int error = errno;
  if (opened >= 0) ::close(opened);
  if (!synced) throw cannotWrite(file, error);
}

void checkWritable(const fs::path& path) {
  const Temporary probe(path);
}

void writeFileAtomically(const fs::path& path, std::string_view text) {
  Temporary file(path);
  file.write(text);
  file.rename();
}

namespace {

struct Replaceable {
  fs::path file;  // where links lead
  fs::perms permissions;
};

Replaceable replaceableAt(const fs::path& path) {
  std::error_code error;
  const fs::path real = fs::canonical(path, error);
  if (error) throw cannotWrite(path, error.message());
  const fs::perms permissions = fs::status(real, error).permissions() & fs::perms::mask;
  constexpr fs::perms kWrite = fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
  if ((permissions & kWrite) == fs::perms::none || ::access(real.c_str(), W_OK) != 0)
    throw cannotWrite(path, "it is read-only");
  return {real, permissions};
}

}  // namespace

void checkReplaceable(const fs::path& path) {
  checkWritable(replaceableAt(path).file);
}

void replaceFileAtomically(const fs::path& path, std::string_view text) {
  const Replaceable there = replaceableAt(path);
  Temporary file(there.file);
  file.write(text);
  file.setPermissions(there.permissions);
  file.rename();
}

}  // namespace weir
