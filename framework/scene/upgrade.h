// Brings old names in the text of a scene file to those of today: what a scene that is read is warned of.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/base/api.h"
#include "framework/scene/scene_file.h"

namespace WEIR_API weir {

struct UpgradedFile {
  std::string file;  ///< the scene, or one that it includes
  std::string text;  ///< what it should hold
};

struct Upgrade {
  std::vector<UpgradedFile> files;   ///< those that change
  std::vector<std::string> changes;  ///< "scene.json:12:9: 'iterations' becomes 'max_iterations'"
};

/// What would change in a scene and in the files that it includes; all else in them stays, byte by byte.
/// Throws an Error if the scene is not valid, or if a repetition or an included file would have to say
/// different things in different places.
Upgrade upgradeOf(const std::filesystem::path& scene, const Registry& registry,
                  const PluginLoader& loadPlugins = {});

}  // namespace weir
