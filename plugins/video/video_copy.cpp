#include "plugins/video/video_copy.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <vector>

#include "framework/base/error.h"
#include "framework/base/file_output.h"
#include "plugins/video/ffmpeg.h"
#include "plugins/video/part_file.h"
#include "plugins/video/video_format.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

void add(std::vector<std::string>& arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
}

/// Up to the first frames of the source.
std::vector<std::string> reading(const fs::path& source, std::int64_t frames) {
  std::vector<std::string> arguments{"-i",    urlOf(source), "-map",
                                     "0:v:0", "-frames:v",   fmt::format("{}", frames)};
  // Else it takes a frame of a hundredth of a second for one that names no time.
  if (source.extension() == ".gif") arguments.insert(arguments.begin(), {"-min_delay", "0"});
  return arguments;
}

void syncContent(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = file >= 0 && (::fsync(file) == 0 || errno == EINVAL);
  const int error = errno;
  if (file >= 0) ::close(file);
  if (!synced) throw cannotWrite(path, std::generic_category().message(error));
}

void keepSynced(PartFile& part) {
  syncContent(part.path());
  part.keep();
  syncFolderOf(part.target());
}

}  // namespace

std::int64_t countFrames(const fs::path& video, std::int64_t max) {
  std::error_code error;
  if (!fs::is_regular_file(video, error))
    throw ioError("there is no such video").at({.file = video.string()});
  std::vector<std::string> arguments = reading(video, max);
  add(arguments, {"-c", "copy", "-f", "null", "-"});
  const auto ffmpeg = startFfmpeg(video, arguments, PipedProgram::kNowhere, max);
  if (!ffmpeg->finish())
    throw ioError("this is not a video that ffmpeg can read", "a video that an earlier run wrote")
        .at({.file = video.string()});
  return toldFrames(*ffmpeg);
}

void copyVideo(const fs::path& source, std::int64_t frames, const fs::path& video, VideoKind kind) {
  const bool growing = kind == VideoKind::kGrowing;
  PartFile part(growing ? growingPlace(video) : video);
  std::vector<std::string> arguments = reading(source, frames);
  // Frames of a .gif that were encoded in parts have headers among them, which no reader expects.
  const bool anew = !growing && growingPlace(video) != video;
  add(arguments,
      anew ? encodingOptions(encodersFor(video, {}).back()) : std::vector<std::string>{"-c", "copy"});
  if (anew) add(arguments, {"-enc_time_base", "1:10000"});  // or times are rounded to a guessed frame rate
  add(arguments, growing ? growingOptions(video) : containerOptions(video));
  add(arguments, {growing ? "pipe:1" : urlOf(part.path())});
  const auto ffmpeg = startFfmpeg(video, arguments, part.path(), frames);
  if (!ffmpeg->finish()) throw failureOf(*ffmpeg, video);
  if (const std::int64_t copied = toldFrames(*ffmpeg); copied < frames)
    throw cannotWrite(video, fmt::format("of {} frames, ffmpeg has copied {}", frames, copied));
  keepSynced(part);
}

void cutFile(const fs::path& file, std::uintmax_t bytes) {
  PartFile part(file);
  std::error_code error;
  fs::copy_file(file, part.path(), fs::copy_options::overwrite_existing, error);
  if (!error) fs::resize_file(part.path(), bytes, error);
  if (error) throw cannotWrite(file, error.message());
  keepSynced(part);
}

void syncFile(const fs::path& file) {
  syncContent(file);
  syncFolderOf(file);
}

}  // namespace weir::rendering
