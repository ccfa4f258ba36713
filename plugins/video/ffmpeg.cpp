#include "plugins/video/ffmpeg.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <sstream>
#include <string_view>
#include <system_error>

#include "framework/base/text.h"
#include "plugins/video/part_file.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

constexpr const char* kLimit = "WEIR_FFMPEG_LIMIT";

/// What the environment says, or what suits all but very slow encoders.
ProgramLimits limits(const fs::path& file) {
  constexpr double kUsual = 60, kLongest = 1e6;  // s
  double seconds = kUsual;
  if (const char* set = std::getenv(kLimit)) {
    const std::string_view text = set;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), seconds);
    if (read.ec != std::errc() || read.ptr != text.data() + text.size() ||
        !(seconds > 0 && seconds <= kLongest))
      throw ioError(fmt::format("the environment variable {} is {}", kLimit, inQuotes(text)),
                    "the seconds that ffmpeg may take no frame, above 0 and up to 1000000")
          .at({.file = file.string()});
  }
  const auto idle =
      std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::duration<double>(seconds));
  return {.idle = idle, .end = 2 * idle};
}

/// A line of -progress: "frame=12", "bitrate= 12.0kbits/s". What ffmpeg complains of begins otherwise.
bool tellsProgress(std::string_view line) {
  const std::size_t key = line.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_");
  return key != std::string_view::npos && key > 0 && line[key] == '=';
}

/// The last lines that a program has written, made safe to show.
std::string lastLines(std::string_view text) {
  constexpr std::size_t kMaxLines = 4, kLongestLine = 200;
  std::vector<std::string> lines;
  while (!text.empty() && lines.size() < kMaxLines) {
    const std::size_t end = text.find_last_not_of("\r\n");
    text = text.substr(0, end == std::string_view::npos ? 0 : end + 1);
    const std::size_t begin = text.find_last_of("\r\n") + 1;  // npos + 1 is 0
    if (!text.empty() && !tellsProgress(text.substr(begin)))
      lines.insert(lines.begin(), printable(text.substr(begin), kLongestLine));
    text = text.substr(0, begin);
  }
  return lines.empty() ? "it gave no reason" : fmt::format("{}", fmt::join(lines, "; "));
}

}  // namespace

Error failureOf(const PipedProgram& ffmpeg, const fs::path& file) {
  const std::string hint = ffmpeg.wasTooSlow()
                               ? fmt::format(
                                     "if it is slow rather than stuck, set {} in the environment to the "
                                     "seconds that it may take no frame (60 without it)",
                                     kLimit)
                               : std::string();
  return cannotWrite(file, "ffmpeg " + ffmpeg.ending() + ": " + lastLines(ffmpeg.messages()), hint);
}

std::string urlOf(const fs::path& file) {
  return "file:" + fs::absolute(file).string();
}

std::int64_t toldFrames(const PipedProgram& ffmpeg) {
  constexpr std::string_view kKey = "frame=";
  const std::string_view messages = ffmpeg.messages();
  const std::size_t at = messages.rfind(kKey);
  std::int64_t frames = 0;
  if (at == std::string_view::npos) return 0;
  const std::size_t digits = messages.find_first_not_of(' ', at + kKey.size());
  if (digits != std::string_view::npos)
    std::from_chars(messages.data() + digits, messages.data() + messages.size(), frames);
  return frames;
}

std::vector<std::string> listEncoders(const fs::path& file) {
  const auto ffmpeg = startFfmpeg(file, {"-encoders"}, "");
  std::vector<std::string> names;
  if (!ffmpeg->finish()) return names;
  // " V....D libx264   libx264 H.264 …": six letters of what it can do, V first for video.
  constexpr std::size_t kLetters = 6;
  std::istringstream lines(ffmpeg->messages());
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string letters, name;
    if (words >> letters >> name && letters.size() == kLetters && letters[0] == 'V') names.push_back(name);
  }
  return names;
}

std::unique_ptr<PipedProgram> startFfmpeg(const fs::path& file, const std::vector<std::string>& arguments,
                                          const fs::path& output, std::int64_t frames) {
  const std::string hint =
      "install ffmpeg (Debian and Ubuntu: apt install ffmpeg; Fedora: dnf install ffmpeg-free; Arch: pacman "
      "-S "
      "ffmpeg), or write single pictures with --images, which works without it";
  // -xerror: without it ffmpeg ends with exit code 0 when the disk is full as it completes the file.
  std::vector<std::string> all{"-hide_banner", "-loglevel", "error",  "-nostdin",      "-y",     "-xerror",
                               "-nostats",     "-progress", "pipe:2", "-stats_period", "1000000"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  try {
    ProgramLimits allowed = limits(file);
    allowed.end += std::chrono::seconds(frames);
    return std::make_unique<PipedProgram>("ffmpeg", all, allowed, output);
  } catch (const std::system_error& error) {
    const bool missing = error.code() == std::errc::no_such_file_or_directory;
    throw cannotWrite(
        file,
        missing ? "the program ffmpeg, which makes videos, is not on the PATH"
                : "the program ffmpeg, which makes videos, cannot be started: " + error.code().message(),
        hint);
  }
}

}  // namespace weir::rendering
