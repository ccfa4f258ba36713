// Starting the program ffmpeg, and what is said where it fails.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "framework/base/error.h"
#include "plugins/video/piped_program.h"

namespace weir::rendering {

/// It says nothing but errors and, at its end, toldFrames(); it fails where it cannot write, and replaces
/// files. `output` as a PipedProgram's. With the limits that the environment variable WEIR_FFMPEG_LIMIT sets:
/// that many seconds without taking a frame, 60 without it, and twice as many at the end, with a second more
/// for each of the `frames` that it reads by itself. Throws an io Error that names the file that it was to
/// make if there is no ffmpeg, or it cannot be started.
std::unique_ptr<PipedProgram> startFfmpeg(const std::filesystem::path& file,
                                          const std::vector<std::string>& arguments,
                                          const std::filesystem::path& output = PipedProgram::kNowhere,
                                          std::int64_t frames = 0);

/// A file's name among ffmpeg's arguments: without file:, a colon in it would mean a protocol.
std::string urlOf(const std::filesystem::path& file);

/// The names of the encoders that ffmpeg has; none if it does not tell. Throws as startFfmpeg() does.
std::vector<std::string> listEncoders(const std::filesystem::path& file);

/// How many frames it has written, as it tells.
std::int64_t toldFrames(const PipedProgram& ffmpeg);

/// What to throw when it has ended: "the file cannot be written: ffmpeg ended with exit code 1: <its words>".
Error failureOf(const PipedProgram& ffmpeg, const std::filesystem::path& file);

}  // namespace weir::rendering
