// Scene files: JSON with places. No type of the JSON library leaves this room.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "framework/scene/scene.h"

namespace weir {

/// The version of the scene format: the value of the key "weir".
inline constexpr int kSceneVersion = 1;
/// Deeper nesting than this is refused, so that no input can exhaust the stack.
inline constexpr int kDeepestNesting = 64;
/// Larger files are refused.
inline constexpr std::size_t kLargestSceneFile = std::size_t{64} << 20;

/// Parses JSON; every value knows its line and column. Throws a scene Error with the place for bad syntax,
/// duplicate keys, numbers that do not fit, invalid UTF-8, and too deep nesting.
Value parseJson(std::string_view text, const std::string& fileName);

/// Writes JSON, floats by their shortest form, short arrays on one line; ends with a newline.
std::string writeJson(const Value& value);

/// Reads a whole file. Throws an io Error that says why it cannot be read.
std::string readTextFile(const std::filesystem::path& path, std::size_t largest);

/// One "--set NODE.PARAM=VALUE", "NODE.MODULE.PARAM=VALUE", "world.PARAM=VALUE" or
/// "render.PARAM[.PARAM]=VALUE". VALUE is JSON, or else a string. Throws a usage Error that says what the
/// form is.
struct Override {
  std::vector<std::string> path;
  Value value;
  std::string text;    ///< "--set water.spacing=0.02", for messages
  std::string folder;  ///< what relative paths in it are relative to: the current folder
};
Override parseOverride(std::string_view text);

/// Builds the scene from its parsed form. Everything is checked; errors name file, line, column and pointer.
/// `warnings` collects what is allowed but doubtful, such as a section that no plugin knows.
std::unique_ptr<Scene> buildScene(const Value& root, const Place& place, const Registry& registry,
                                  const std::vector<Override>& overrides, std::vector<std::string>& warnings);

/// readTextFile, parseJson and buildScene.
std::unique_ptr<Scene> loadScene(const std::filesystem::path& path, const Registry& registry,
                                 const std::vector<Override>& overrides, std::vector<std::string>& warnings);

/// The scene as a value that buildScene reads back to the same scene.
Value sceneToValue(const Scene& scene);

/// JSON Schema (draft 2020-12) of scene files, for everything that the registry knows.
Value sceneSchema(const Registry& registry);

}  // namespace weir
