// The sources of shaders: the files of the folder shaders/, which the build puts into the program.
#pragma once

#include <string>

namespace weir::rendering::gl {

/// A whole shader of the file shaders/NAME.glsl: the version, lines of #define, and the file, in which each
/// line `#include "other.glsl"` has become that file, once. "patterns.glsl" is written by this program: the
/// places of patterns.h.
std::string shaderSource(const std::string& name, const std::string& defines = {});

}  // namespace weir::rendering::gl
