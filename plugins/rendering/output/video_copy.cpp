#include "plugins/rendering/output/video_copy.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <string_view>
#include <system_error>

#include "framework/base/error.h"
#include "plugins/rendering/output/ffmpeg.h"
#include "plugins/rendering/output/part_file.h"
#include "plugins/rendering/output/video_format.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

// Without file:, a colon in the name would mean a protocol.
std::string urlOf(const fs::path& file) {
  return "file:" + fs::absolute(file).string();
}

/// In a list for ffmpeg, where a quote within quotes ends them.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

void add(std::vector<std::string>& arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
}

/// Copies into `part`, with the options of the file that it will be.
void copyInto(const PartFile& part, const std::vector<std::string>& input, std::string_view fed,
              const std::vector<std::string>& output) {
  std::vector<std::string> arguments{"-hide_banner", "-loglevel", "error", "-nostdin", "-y", "-xerror"};
  add(arguments, input);
  add(arguments, {"-map", "0:v:0", "-c", "copy"});
  add(arguments, output);
  add(arguments, containerOptions(part.target()));
  add(arguments, {urlOf(part.path())});
  const auto ffmpeg = startFfmpeg(part.target(), arguments);
  const bool taken = ffmpeg->write({reinterpret_cast<const std::uint8_t*>(fed.data()), fed.size()});
  if (!ffmpeg->finish() || !taken) throw failureOf(*ffmpeg, part.target());
}

void syncPath(const fs::path& path, int flags) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | flags);
  const bool synced = file >= 0 && (::fsync(file) == 0 || errno == EINVAL);
  const int error = errno;
  if (file >= 0) ::close(file);
  if (!synced) throw cannotWrite(path, std::generic_category().message(error));
}

}  // namespace

std::int64_t countFrames(const fs::path& video) {
  std::error_code error;
  if (!fs::is_regular_file(video, error))
    throw ioError("there is no such video").at({.file = video.string()});
  const auto ffmpeg =
      startFfmpeg(video, {"-hide_banner", "-loglevel", "error", "-nostdin", "-nostats", "-progress", "pipe:2",
                          "-i", urlOf(video), "-map", "0:v:0", "-c", "copy", "-f", "null", "-"});
  if (!ffmpeg->finish())
    throw ioError("this is not a video that ffmpeg can read", "a video that an earlier run wrote")
        .at({.file = video.string()});
  return toldFrames(*ffmpeg);
}

void cutVideo(const fs::path& video, std::int64_t frames) {
  PartFile part(video);
  copyInto(part, {"-i", urlOf(video)}, {}, {"-frames:v", fmt::format("{}", frames)});
  syncPath(part.path(), 0);
  part.keep();
}

void joinVideos(const std::vector<VideoPiece>& pieces, const fs::path& video) {
  PartFile part(video);
  std::string list = "ffconcat version 1.0\n";
  // The durations, as those that ffmpeg finds in the files are rounded to milliseconds.
  for (const VideoPiece& piece : pieces)
    list += fmt::format("file {}\nduration {:.6f}\n", quoted(urlOf(piece.file)), piece.seconds);
  copyInto(part, {"-f", "concat", "-safe", "0", "-protocol_whitelist", "file,pipe", "-i", "pipe:0"}, list,
           {});
  syncPath(part.path(), 0);
  part.keep();
}

void syncFile(const fs::path& file) {
  syncPath(file, 0);
  syncPath(fs::absolute(file).parent_path(), O_DIRECTORY);
}

}  // namespace weir::rendering
