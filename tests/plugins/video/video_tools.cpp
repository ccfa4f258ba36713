#include "tests/plugins/video/video_tools.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>

namespace weir::test {

VideoInfo probeVideo(const std::string& file) {
  const ChildResult result =
      runChild(findProgram("ffprobe"),
               {"-v", "error", "-count_frames", "-select_streams", "v", "-of", "default=noprint_wrappers=1",
                "-show_entries",
                "stream=width,height,nb_read_frames,r_frame_rate,codec_name,pix_fmt,color_space", file});
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.err, "");
  std::map<std::string, std::string> fields;
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find('=');
    fields[line.substr(0, equals)] = line.substr(equals + 1);
  }
  const auto number = [&](const char* name) { return std::atoi(fields[name].c_str()); };
  return {number("width"),      number("height"),  number("nb_read_frames"), fields["r_frame_rate"],
          fields["codec_name"], fields["pix_fmt"], fields["color_space"]};
}

std::vector<rendering::Picture> readVideo(const std::string& file) {
  const TemporaryFolder folder;
  const VideoInfo info = probeVideo(file);
  const ChildResult result = runChild(findProgram("ffmpeg"), {"-v", "error", "-i", file, "-f", "rawvideo",
                                                              "-pix_fmt", "rgb24", folder / "frames.rgb"});
  EXPECT_EQ(result.err, "");
  const std::string bytes = readFile(folder / "frames.rgb");
  std::vector<rendering::Picture> frames;
  rendering::Picture frame{info.width, info.height, {}};
  const std::size_t size = frame.byteCount();
  EXPECT_EQ(bytes.size(), size * static_cast<std::size_t>(info.frames));
  for (std::size_t at = 0; at + size <= bytes.size() && size > 0; at += size) {
    frame.rgb.assign(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                     bytes.begin() + static_cast<std::ptrdiff_t>(at + size));
    frames.push_back(frame);
  }
  return frames;
}

PathVariable::PathVariable(const std::string& value) : before_(std::getenv("PATH")) {
  ::setenv("PATH", value.c_str(), 1);
}

PathVariable::~PathVariable() {
  ::setenv("PATH", before_.c_str(), 1);
}

namespace {

std::string writeProgram(const TemporaryFolder& folder, const std::string& script) {
  const std::string file =
      folder.write("ffmpeg", "#!/bin/sh\nPATH=" + std::string(std::getenv("PATH")) + "\n" + script + "\n");
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  return folder.path();
}

}  // namespace

std::string writesFrames(int frames) {
  return "for file; do :; done; echo video > \"${file#file:}\"; echo frame=" + std::to_string(frames) +
         " >&2; ";
}

FakeFfmpeg::FakeFfmpeg(const std::string& script, const std::string& trial)
    : path_(writeProgram(folder_, "FOLDER='" + folder_.path() +
                                      "'\n"
                                      "if [ ! -e \"$FOLDER/tried\" ]; then\n"
                                      "  : > \"$FOLDER/tried\"; " +
                                      trial +
                                      "; exit 0\n"
                                      "fi\n" +
                                      script)) {}

FfmpegWithout::FfmpegWithout(const std::string& word)
    : path_(writeProgram(folder_, "case \"$*\" in *" + word + "*) echo 'Unknown " + word +
                                      "' >&2; exit 1;; esac\nexec " + findProgram("ffmpeg") + " \"$@\"")) {}

}  // namespace weir::test
