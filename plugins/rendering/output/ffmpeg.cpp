#include "plugins/rendering/output/ffmpeg.h"

#include <fmt/format.h>

#include <sstream>
#include <string_view>
#include <system_error>

#include "framework/base/text.h"
#include "plugins/rendering/output/part_file.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

/// The last lines that a program has written, made safe to show.
std::string lastLines(std::string_view text) {
  constexpr std::size_t kMostLines = 4, kLongestLine = 200;
  std::vector<std::string> lines;
  while (!text.empty() && lines.size() < kMostLines) {
    const std::size_t end = text.find_last_not_of("\r\n");
    text = text.substr(0, end == std::string_view::npos ? 0 : end + 1);
    const std::size_t begin = text.find_last_of("\r\n") + 1;  // npos + 1 is 0
    if (!text.empty()) lines.insert(lines.begin(), printable(text.substr(begin), kLongestLine));
    text = text.substr(0, begin);
  }
  return lines.empty() ? "it gave no reason" : fmt::format("{}", fmt::join(lines, "; "));
}

}  // namespace

Error failureOf(const PipedProgram& ffmpeg, const fs::path& file) {
  return cannotWrite(file, "ffmpeg " + ffmpeg.ending() + ": " + lastLines(ffmpeg.messages()));
}

std::vector<std::string> listEncoders(const fs::path& file) {
  const auto ffmpeg = startFfmpeg(file, {"-hide_banner", "-encoders"}, ProgramOutput::kKept);
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
                                          ProgramOutput output) {
  const std::string hint =
      "install ffmpeg (Debian and Ubuntu: apt install ffmpeg; Fedora: dnf install ffmpeg-free; Arch: pacman "
      "-S "
      "ffmpeg), or write single pictures with --images, which works without it";
  try {
    return std::make_unique<PipedProgram>("ffmpeg", arguments, output);
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
