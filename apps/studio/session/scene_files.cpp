#include "apps/studio/session/scene_files.h"

#include <algorithm>

#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir::studio {

namespace fs = std::filesystem;

namespace {

/// The texts of the files that a parameter names; none if it is of another type.
std::vector<std::string> filesOf(const Property& property, const Value& value) {
  if (dynamic_cast<const Param<FilePath>*>(&property) != nullptr) return {value.asString()};
  std::vector<std::string> files;
  if (dynamic_cast<const Param<std::vector<FilePath>>*>(&property) != nullptr)
    for (const Value& file : value.asArray()) files.push_back(file.asString());
  return files;
}

}  // namespace

SceneFiles::SceneFiles(const ServedFolder& served, const std::vector<fs::path>& further) : folders_{served} {
  for (const fs::path& folder : further) folders_.emplace_back(folder);
}

void SceneFiles::check(const Scene& scene, const fs::path& folder) const {
  const auto checkOwner = [&](const Configurable& owner, const std::string& node) {
    try {
      checkAll(owner, owner.changedValues(), folder);
    } catch (Error& e) {
      throw e.inNode(node);
    }
  };
  for (const auto& node : scene.graph.nodes()) {
    checkOwner(*node, node->name());
    if (node->pipeline() != nullptr)
      for (const auto& module : node->pipeline()->modules()) checkOwner(*module, node->name());
  }
  for (const auto& [name, section] : scene.sections) checkOwner(*section, name);
}

void SceneFiles::checkAll(const Configurable& owner, const Value& values, const fs::path& folder) const {
  for (const Property* property : owner.properties()) {
    const Value* value = values.find(property->name());
    if (value == nullptr || value->isNull()) continue;
    try {
      for (const std::string& file : filesOf(*property, *value))
        if (!file.empty()) checkFile(folder / file);
    } catch (Error& e) {
      throw e.at(property->origin()).inParameter(property->name());
    }
    if (property->group() == nullptr) continue;
    if (value->isArray())
      for (const Value& item : value->asArray()) checkAll(*property->group(), item, folder);
    else
      checkAll(*property->group(), *value, folder);
  }
}

void SceneFiles::checkFile(const fs::path& file) const {
  const bool isInside = std::any_of(folders_.begin(), folders_.end(),
                                    [&](const ServedFolder& folder) { return folder.contains(file); });
  const std::string shown = file.lexically_normal().string();
  if (!isInside)
    throw sceneError(
        "the studio may not read " + inQuotes(shown),
        "files below " + inQuotes(folders_.front().root().string()) + " that are not hidden",
        "started with --allow-files and a folder, it lets scenes read the files of that one, too");
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
    throw sceneError("the studio cannot read " + inQuotes(shown), "a regular file");
}

}  // namespace weir::studio
