#include "framework/base/growing_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "framework/base/error.h"
#include "framework/base/file_output.h"

namespace weir {

namespace {

Error failed(const std::filesystem::path& path, const std::string& what, int error) {
  return ioError(what + ": " + std::generic_category().message(error)).at({.file = path.string()});
}

Error isAnother(const std::filesystem::path& path, const std::string& found) {
  return ioError("the file cannot be gone on with: " + found, "the file as the run left it",
                 "put it back, or run the scene from the start")
      .at({.file = path.string()});
}

}  // namespace

GrowingFile::Mark GrowingFile::markOf(std::string_view text) {
  return {static_cast<std::int64_t>(text.size()), Digest().add(std::as_bytes(std::span(text))).value()};
}

GrowingFile::GrowingFile(std::filesystem::path path) : path_(std::move(path)) {
  writeFileAtomically(path_, "");
  open();
}

GrowingFile::GrowingFile(std::filesystem::path path, const Mark& mark) : path_(std::move(path)) {
  open();
  try {
    digestUpTo(mark.bytes);
    if (digest_.value() != mark.digest)
      throw isAnother(path_, "it is not what stood there at the checkpoint");
    if (::ftruncate(file_, mark.bytes) != 0) throw failed(path_, "the file cannot be cut", errno);
  } catch (...) {
    ::close(file_);
    throw;
  }
}

GrowingFile::~GrowingFile() {
  if (file_ >= 0) ::close(file_);
}

void GrowingFile::open() {
  file_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
  if (file_ < 0) throw failed(path_, "the file cannot be opened", errno);
}

void GrowingFile::digestUpTo(std::int64_t bytes) {
  constexpr std::int64_t kBlock = 1 << 16;
  std::vector<std::byte> block(kBlock);
  while (bytes_ < bytes) {
    const auto wanted = static_cast<std::size_t>(std::min(kBlock, bytes - bytes_));
    const ssize_t read = ::pread(file_, block.data(), wanted, bytes_);
    if (read < 0 && errno == EINTR) continue;
    if (read < 0) throw failed(path_, "the file cannot be read", errno);
    if (read == 0) throw isAnother(path_, "it is shorter than it was at the checkpoint");
    digest_.add(std::span(block).first(static_cast<std::size_t>(read)));
    bytes_ += read;
  }
}

void GrowingFile::append(std::string_view text) {
  std::int64_t end = bytes_;
  for (std::string_view rest = text; !rest.empty();) {
    const ssize_t written = ::pwrite(file_, rest.data(), rest.size(), end);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      Error error = failed(path_, "the file cannot be written", errno);
      if (::ftruncate(file_, bytes_) != 0)
        error = failed(path_, "the file cannot be written, nor cut where it ended", errno);
      throw error;
    }
    end += written;
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
  bytes_ = end;
  digest_.add(std::as_bytes(std::span(text)));
}

GrowingFile::Mark GrowingFile::sync() {
  if (::fsync(file_) != 0 && errno != EINVAL) throw failed(path_, "the file cannot be written", errno);
  return {bytes_, digest_.value()};
}

void GrowingFile::close() {
  if (::close(std::exchange(file_, -1)) != 0) throw failed(path_, "the file cannot be written", errno);
}

}  // namespace weir
