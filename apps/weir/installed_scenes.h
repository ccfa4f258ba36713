// The scenes that come with Weir, which commands know by name: dam_break, gallery/goblet.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace weir::app {

/// Where they are: share/weir/scenes.
std::filesystem::path sceneFolder();

/// Their names, sorted, those of no folder first. A name is the path in sceneFolder() without ".json".
std::vector<std::string> installedScenes();

/// Throws a usage Error with a suggestion if there is no such scene.
std::filesystem::path installedScene(const std::string& name);

/// What an index of the folder says of a scene, or "".
std::string descriptionOf(const std::string& name);

/// The file that the argument SCENE of a command means: a file if there is one at that path, else the
/// installed scene of that name. Names have letters, digits, '_', '-' and, but for the first, '/'; all else
/// is a path.
std::string sceneFile(const std::string& given);

/// For the help of commands.
inline constexpr const char* kSceneHelp = "The scene file; or where there is none, a name of 'weir scenes'";

}  // namespace weir::app
