// The files of the folder shaders/ as the build has embedded them (embed_texts.cmake).
#pragma once

#include <span>
#include <string_view>

namespace weir::rendering::gl {

struct ShaderFile {
  std::string_view name, text;
};
std::span<const ShaderFile> shaderFiles();

}  // namespace weir::rendering::gl
