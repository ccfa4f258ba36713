#include "plugins/rendering/gl/shaders.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <span>
#include <sstream>
#include <string_view>

#include "framework/base/check.h"
#include "plugins/rendering/gl/shader_files.h"
#include "plugins/rendering/shading/patterns.h"

namespace weir::rendering::gl {

namespace {

/// "const vec2 NAME[N] = vec2[](…);" with all digits: compute kernels have the same places, and where a place
/// is rounded to a texel, a last digit can decide which.
std::string constantPlaces(std::string_view name, std::span<const Vec2f> places) {
  std::string list;
  for (const Vec2f& place : places)
    list += fmt::format("{}vec2({:.9g}, {:.9g})", list.empty() ? "" : ", ", place.x, place.y);
  return fmt::format("const vec2 {}[{}] = vec2[]({});\n", name, places.size(), list);
}

std::string patterns() {
  const ShadowPattern shadow = shadowPattern();
  const OcclusionPattern occlusion = occlusionPattern();
  return constantPlaces("kShadowTaps", shadow.taps) + constantPlaces("kShadowTurns", shadow.turns) +
         constantPlaces("kOcclusionTaps", occlusion.taps) +
         constantPlaces("kOcclusionTurns", occlusion.turns);
}

std::string textOf(const std::string& file) {
  if (file == "patterns.glsl") return patterns();
  const auto files = shaderFiles();
  const auto found = std::find_if(files.begin(), files.end(), [&](const auto& f) { return f.name == file; });
  if (found == files.end()) throw InternalError("there is no shader file " + file);
  return std::string(found->text);
}

void add(const std::string& file, std::set<std::string>& there, std::string& source) {
  constexpr std::string_view kInclude = "#include \"";
  if (!there.insert(file).second) return;
  std::istringstream lines(textOf(file));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(kInclude))
      add(line.substr(kInclude.size(), line.rfind('"') - kInclude.size()), there, source);
    else
      source += line + '\n';
}

}  // namespace

std::string shaderSource(const std::string& name, const std::string& defines) {
  std::string source = "#version 330 core\n" + defines;
  std::set<std::string> there;
  add(name + ".glsl", there, source);
  return source;
}

}  // namespace weir::rendering::gl
