#include "apps/studio/server/served_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <system_error>

#include "framework/base/error.h"
#include "framework/base/file_output.h"
#include "framework/base/text.h"
#include "framework/scene/scene_file.h"

namespace weir::studio {

namespace fs = std::filesystem;

namespace {

bool isBelow(const fs::path& path, const fs::path& root) {
  const auto [rest, unused] = std::mismatch(root.begin(), root.end(), path.begin(), path.end());
  return rest == root.end();
}

/// Whether there is a link to nothing in a path below the root, all of whose other links are resolved. What
/// is written there might come to lie elsewhere.
bool hasDanglingLink(fs::path path, const fs::path& root) {
  std::error_code error;
  for (; path != root && path.has_relative_path(); path = path.parent_path())
    if (fs::is_symlink(fs::symlink_status(path, error))) return true;
  return false;
}

bool isPlain(std::string_view text) {
  return isUtf8(text) && std::none_of(text.begin(), text.end(), [](char c) {
           constexpr unsigned char kSpace = 0x20, kDelete = 0x7f;
           return static_cast<unsigned char>(c) < kSpace || static_cast<unsigned char>(c) == kDelete ||
                  c == '\\';
         });
}

/// Whether a part of a path has the name of something hidden.
bool isHidden(const fs::path& path) {
  return std::any_of(path.begin(), path.end(), [](const fs::path& part) {
    return part.native().starts_with('.') && part != "." && part != "..";
  });
}

/// When something was written, s since 1970; 0 where nobody knows.
std::int64_t writtenAt(const fs::directory_entry& entry) {
  std::error_code error;
  const fs::file_time_type time = entry.last_write_time(error);
  if (error) return 0;
  const auto system = std::chrono::file_clock::to_sys(time);
  return std::chrono::duration_cast<std::chrono::seconds>(system.time_since_epoch()).count();
}

/// A file that is open, and closed at the end.
class OpenFile {
 public:
  /// Does not wait for the other end of a pipe.
  explicit OpenFile(const fs::path& path) : file_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {}
  ~OpenFile() {
    if (file_ >= 0) ::close(file_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  bool isOpen() const { return file_ >= 0; }
  bool isRegular() const {
    struct stat found {};
    return ::fstat(file_, &found) == 0 && S_ISREG(found.st_mode);
  }
  /// As read(2), but goes on after a signal.
  ssize_t read(char* to, std::size_t max) const {
    ssize_t got = -1;
    do got = ::read(file_, to, max);
    while (got < 0 && errno == EINTR);
    return got;
  }

 private:
  int file_;
};

}  // namespace

std::string readRegularFile(const fs::path& file, std::string_view name) {
  const auto fail = [&](const std::string& why) {
    throw ioError("the file " + inQuotes(name) + " cannot be read: " + why);
  };
  const OpenFile open(file);
  if (!open.isOpen()) fail(std::generic_category().message(errno));
  if (!open.isRegular()) fail("it is not a regular file");
  constexpr std::size_t kBlock = 1 << 16;
  std::string text;
  for (ssize_t got = 1; got > 0;) {
    const std::size_t before = text.size();
    text.resize(before + kBlock);
    got = open.read(text.data() + before, kBlock);
    if (got < 0) fail(std::generic_category().message(errno));
    text.resize(before + static_cast<std::size_t>(got));
    if (text.size() > std::size_t{ServedFolder::kLargestUpload})
      fail("it is larger than " + std::to_string(ServedFolder::kLargestUpload) + " bytes");
  }
  return text;
}

ServedFolder::ServedFolder(const fs::path& folder) {
  std::error_code error;
  root_ = fs::canonical(folder, error);
  if (error || !fs::is_directory(root_, error))
    throw ioError("there is no folder " + inQuotes(folder.string()), "a folder that exists");
}

fs::path ServedFolder::resolve(std::string_view path) const {
  const fs::path relative = path;
  if (!isPlain(path) || relative.is_absolute())
    throw usageError("the path " + inQuotes(path) + " cannot be used", "a path below the served folder");
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(root_ / relative, error);
  if (error || !isBelow(whole, root_) || hasDanglingLink(whole, root_))
    throw usageError("the path " + inQuotes(path) + " leads out of the served folder",
                     "a path below " + inQuotes(root_.string()));
  if (isHidden(relative) || isHidden(whole.lexically_relative(root_)))
    throw usageError("the path " + inQuotes(path) + " leads to something hidden",
                     "names that do not begin with a dot");
  return whole;
}

bool ServedFolder::contains(const fs::path& path) const {
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(path, error);
  return !error && isBelow(whole, root_) && !hasDanglingLink(whole, root_) &&
         !isHidden(whole.lexically_relative(root_));
}

std::vector<ServedFile> ServedFolder::list(std::string_view folder) const {
  const fs::path where = resolve(folder);
  std::error_code error;
  std::vector<ServedFile> files;
  for (fs::directory_iterator i(where, error), end; !error && i != end; i.increment(error)) {
    const std::string name = i->path().filename().string();
    if (name.starts_with('.') || !isPlain(name)) continue;
    std::error_code ignored;
    ServedFile file;
    file.path = i->path().lexically_relative(root_).generic_string();
    file.isFolder = i->is_directory(ignored);
    if (!file.isFolder) file.bytes = static_cast<std::int64_t>(i->file_size(ignored));
    file.modified = writtenAt(*i);
    files.push_back(std::move(file));
    if (files.size() == kMaxListed) break;
  }
  if (error && error != std::errc::no_such_file_or_directory)
    throw ioError("the folder " + inQuotes(folder) + " cannot be read: " + error.message());
  std::sort(files.begin(), files.end(), [](const ServedFile& a, const ServedFile& b) {
    return std::pair(!a.isFolder, a.path) < std::pair(!b.isFolder, b.path);
  });
  return files;
}

std::string ServedFolder::read(std::string_view path) const {
  return readRegularFile(resolve(path), path);
}

fs::path ServedFolder::placeFor(std::string_view path) const {
  fs::path file = resolve(path);
  if (file == root_) throw usageError("a file needs a name", "a path below the served folder");
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  return file;
}

void ServedFolder::write(std::string_view path, std::string_view content) const {
  writeFileAtomically(placeFor(path), content);
}

fs::path ServedFolder::partOf(std::string_view path) const {
  const fs::path file = placeFor(path);
  checkWritable(file);
  static std::atomic<std::int64_t> parts = 0;
  return file.parent_path() / ("." + file.filename().string() + "." + std::to_string(getpid()) + "-" +
                               std::to_string(++parts) + ".part");
}

void ServedFolder::take(const fs::path& part, std::string_view path) const {
  std::error_code error;
  fs::rename(part, resolve(path), error);
  if (error) throw ioError("the file " + inQuotes(path) + " cannot be written: " + error.message());
}

}  // namespace weir::studio
