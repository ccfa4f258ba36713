// Which files a scene in the studio may read: those of the served folder, and of folders that the user has
// allowed when the studio was started. A scene may come from anybody.
#pragma once

#include <filesystem>
#include <vector>

#include "apps/studio/server/served_folder.h"
#include "framework/scene/scene.h"

namespace weir::studio {

class SceneFiles {
 public:
  /// Throws an io Error if one of the folders is not there.
  SceneFiles(const ServedFolder& served, const std::vector<std::filesystem::path>& further);

  /// Throws a scene Error if the scene names a file that it may not read: one that lies elsewhere, is hidden,
  /// or is not a regular file. `folder` is what its relative paths are relative to.
  void check(const Scene& scene, const std::filesystem::path& folder) const;

 private:
  void checkAll(const Configurable& owner, const Value& values, const std::filesystem::path& folder) const;
  void checkFile(const std::filesystem::path& file) const;

  std::vector<ServedFolder> folders_;  // the served one first
};

}  // namespace weir::studio
