// Scene files: JSON with places. No type of the JSON library leaves this room.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/scene/scene.h"

namespace WEIR_API weir {

/// The version of the scene format: the value of the key "weir".
inline constexpr int kSceneVersion = 1;
/// Deeper nesting than this is refused, so that no input can exhaust the stack.
inline constexpr int kDeepestNesting = 64;
/// Larger files are refused, and so are scenes of more nodes or links: no input may exhaust memory or time.
inline constexpr std::size_t kLargestSceneFile = std::size_t{16} << 20;
inline constexpr std::size_t kMaxNodes = 2000;
inline constexpr std::size_t kMaxLinks = 10000;

/// Parses JSON; every value knows its line and column. Throws a scene Error with the place for bad syntax,
/// duplicate keys, numbers that do not fit, invalid UTF-8, and too deep nesting.
Value parseJson(std::string_view text, const std::string& fileName);
/// The same for a scene file, which may also have comments, // and /* */, and trailing commas.
Value parseScene(std::string_view text, const std::string& fileName);

/// Writes JSON, floats by their shortest form, short arrays and objects on one line; ends with a newline.
/// parseJson gives back an equal value, but for what JSON cannot hold: NaN and infinity are written as null,
/// bytes that are no UTF-8 as U+FFFD.
std::string writeJson(const Value& value);
/// The same on a single line, however long, for files of one object a line (JSON Lines).
std::string writeJsonLine(const Value& value);

/// Reads a whole file. Throws an io Error that says why it cannot be read.
std::string readTextFile(const std::filesystem::path& path, std::size_t largest);

/// A change to a scene before it is built: NODE.PARAM, NODE.MODULE.PARAM, world.PARAM, render.PARAM, let.NAME
/// or title.
/// Parameters in groups and lists are reached by more parts: render.camera.eye, render.keyframes.0.time.
struct Override {
  std::vector<std::string> path;
  Value value;  ///< its origin names the option
};

/// Parses "water.spacing=0.02". What stands behind '=' is JSON, or else a string; broken JSON that begins as
/// an array, object or string is an error. Relative paths in it are relative to the current folder. Throws a
/// usage Error that says what the form is.
Override parseOverride(std::string_view text);

/// The scene's value with the overrides put in, in their order. Throws a scene Error that names the override
/// if there is no such node, module or section. Whether the parameter exists and may have that value is
/// checked by buildScene, like all that stands in the file.
Value applyOverrides(Value root, const Registry& registry, const std::vector<Override>& overrides);

/// The scene with the files of its "$include" members, each merged below the members beside it. Included
/// files stand in the folder of the scene, which is `place.folder`, or below it. Throws a scene Error where
/// not.
Value withIncludes(Value root, const Place& place);

/// The plugins that the scene names, to be loaded before it is built. Throws a scene Error if the list is
/// malformed.
std::vector<FilePath> scenePlugins(const Value& root, const Place& place);

/// Builds the scene from its parsed form, as it is written: with $include, let, repeat, expressions and notes
/// or without. Everything is checked; errors name file, line, column and pointer.
/// `warnings` collects what is allowed but doubtful, such as a section that no plugin knows.
std::unique_ptr<Scene> buildScene(const Value& root, const Place& place, const Registry& registry,
                                  const std::vector<Override>& overrides, std::vector<std::string>& warnings);

/// Loads the plugins that a scene names into the registry that it is built with.
using PluginLoader = std::function<void(const std::vector<FilePath>&)>;

/// How a scene is written.
struct WrittenForm {
  bool comments = false;   ///< comments or trailing commas in the text
  bool notes = false;      ///< "note" somewhere
  bool shorthand = false;  ///< $include, let, repeat, an expression or a number with a unit somewhere
  bool isPlain() const { return !comments && !notes && !shorthand; }
};
WrittenForm writtenForm(std::string_view text, const Value& root);

/// What scene.text becomes: the text itself where it is plain JSON, otherwise the scene written out, with
/// overrides, so that it stands alone and programs that know only the plain format read it.
std::string textToKeep(std::string text, const Value& root, const Scene& scene);

/// readTextFile, parseScene and buildScene. Without a loader, the plugins that the scene names must be there.
std::unique_ptr<Scene> loadScene(const std::filesystem::path& path, const Registry& registry,
                                 const std::vector<Override>& overrides, std::vector<std::string>& warnings,
                                 const PluginLoader& loadPlugins = {});

/// The scene as a value that buildScene reads back to the same scene. Only what differs from the defaults is
/// written. Relative paths are as they were read, so it belongs into the folder that it was read from.
Value sceneToValue(const Scene& scene);

/// JSON Schema (draft 2020-12) of scene files, for everything that the registry knows.
Value sceneSchema(const Registry& registry);

}  // namespace weir
