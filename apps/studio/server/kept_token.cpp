#include "apps/studio/server/kept_token.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <optional>
#include <system_error>
#include <utility>

#include "apps/studio/server/access.h"
#include "framework/base/digest.h"

namespace weir::studio {

namespace fs = std::filesystem;

namespace {

constexpr mode_t kForOthers = S_IRWXG | S_IRWXO, kOthersWrite = S_IWGRP | S_IWOTH;
constexpr std::time_t kLongestSeconds = std::time_t{30} * 24 * 3600;
constexpr std::size_t kTokenDigits = 32;

/// An open file, closed at the end.
class File {
 public:
  File(const fs::path& path, int flags)
      : file_(::open(path.c_str(), flags | O_NOFOLLOW | O_CLOEXEC, S_IRUSR | S_IWUSR)) {}
  ~File() {
    if (file_ >= 0) ::close(file_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  bool isOpen() const { return file_ >= 0; }
  int number() const { return file_; }

 private:
  int file_;
};

bool isThisMachine(const std::string& host) {
  return host == "127.0.0.1" || host == "::1" || host == "localhost";
}

/// What stands in the file: the token, and whose it is, as two folders may have the same digest.
std::string textOf(const std::string& token, const TokenOwner& owner) {
  return token + "\n" + owner.served.string() + "\n";
}

fs::path fileOf(const fs::path& folder, const TokenOwner& owner) {
  const std::uint32_t digest = Digest().addText(owner.served.string()).addText(owner.host).value();
  return folder / (std::to_string(owner.port) + "-" + std::to_string(digest) + ".token");
}

/// Makes the folder and those above it. Why nothing can be kept there, or nothing.
std::string folderProblem(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder.parent_path(), error);
  if (::mkdir(folder.c_str(), S_IRWXU) != 0 && errno != EEXIST)
    return folder.string() + " cannot be made: " + std::generic_category().message(errno);
  struct stat found {};
  if (::lstat(folder.c_str(), &found) != 0 || !S_ISDIR(found.st_mode))
    return folder.string() + " is no folder";
  if (found.st_uid != ::geteuid()) return folder.string() + " belongs to somebody else";
  if ((found.st_mode & kOthersWrite) != 0) return "others may write to " + folder.string();
  return {};
}

/// Why a file that was found is not believed; nothing if it is.
std::string fileProblem(const struct stat& found) {
  if (!S_ISREG(found.st_mode) || found.st_nlink != 1) return "is no file of its own";
  if (found.st_uid != ::geteuid()) return "belongs to somebody else";
  if ((found.st_mode & kForOthers) != 0) return "could be read by others";
  return {};
}

bool isTokenText(std::string_view text) {
  return text.size() == kTokenDigits && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// The token that a file keeps; nothing if there is none, and `problem` if it is not believed.
std::optional<std::string> readToken(const fs::path& path, const TokenOwner& owner, std::string& problem) {
  const File file(path, O_RDONLY | O_NONBLOCK);
  if (!file.isOpen()) {
    if (errno != ENOENT)
      problem = path.string() + " cannot be read: " + std::generic_category().message(errno);
    return std::nullopt;
  }
  struct stat found {};
  if (::fstat(file.number(), &found) != 0) return std::nullopt;
  if (const std::string why = fileProblem(found); !why.empty()) {
    problem = path.string() + " " + why;
    return std::nullopt;
  }
  if (std::time(nullptr) - found.st_mtime > kLongestSeconds) return std::nullopt;
  std::string text(textOf(std::string(kTokenDigits, '0'), owner).size() + 1, '\0');
  const ssize_t bytes = ::read(file.number(), text.data(), text.size());
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(bytes, 0)));
  std::string token = text.substr(0, kTokenDigits);
  if (!isTokenText(token) || text != textOf(token, owner)) return std::nullopt;
  return token;
}

/// Why the token could not be written; nothing if it was.
std::string writeToken(const fs::path& path, const std::string& text) {
  // Never into a file that is there: somebody may have it open.
  ::unlink(path.c_str());
  const File file(path, O_WRONLY | O_CREAT | O_EXCL);
  if (file.isOpen() && ::write(file.number(), text.data(), text.size()) == static_cast<ssize_t>(text.size()))
    return {};
  return path.string() + " cannot be written: " + std::generic_category().message(errno);
}

}  // namespace

fs::path folderOfTokens() {
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && fs::path(state).is_absolute()) return fs::path(state) / "weir/studio";
  const char* home = std::getenv("HOME");
  if (home != nullptr && fs::path(home).is_absolute()) return fs::path(home) / ".local/state/weir/studio";
  return {};
}

KeptToken keptToken(const fs::path& folder, const TokenOwner& owner, bool fresh) {
  KeptToken kept{randomToken(), {}};
  if (folder.empty() || owner.port == 0 || !isThisMachine(owner.host)) return kept;
  std::error_code error;
  const TokenOwner known{fs::weakly_canonical(owner.served, error), owner.host, owner.port};
  kept.problem = folderProblem(folder);
  if (!kept.problem.empty()) return kept;
  const fs::path file = fileOf(folder, known);
  if (!fresh)
    if (auto token = readToken(file, known, kept.problem)) return {std::move(*token), {}};
  if (const std::string why = writeToken(file, textOf(kept.token, known)); !why.empty()) kept.problem = why;
  return kept;
}

}  // namespace weir::studio
