// Runs of the program with all outputs, and looking into what they wrote.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "framework/base/value.h"
#include "tests/support/child_process.h"

namespace weir::test {

/// A scene with all that has a state of its own: an emitter, a sink, a moving solid, and a solver that
/// iterates as needed, in steps that follow the motion. 21 frames.
extern const char* const kStateful;
inline constexpr int kStatefulFrames = 21;

/// Whether ffmpeg and ffprobe are there.
bool canMakeVideos();

/// The frames of a --series file, without the times that they took.
std::vector<Value> seriesIn(const std::string& file);

/// All steps of two exports are the same, bit by bit.
void expectSameExports(const std::string& one, const std::string& other);

/// VTK itself reads all steps of the export, where the build knows a Python that has it (the first one of
/// WEIR_TEST_PYTHONS); Weir's own reader does anyway. Returns how many steps there are.
std::size_t expectReadable(const std::string& file);

}  // namespace weir::test
