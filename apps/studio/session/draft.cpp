#include "apps/studio/session/draft.h"

#include <filesystem>

#include "framework/base/error.h"
#include "framework/scene/scene_file.h"

namespace weir::studio {

namespace fs = std::filesystem;

namespace {

std::string draftOf(const std::string& path) {
  const fs::path scene = path.empty() ? fs::path("untitled.json") : fs::path(path);
  return (scene.parent_path() / ("." + scene.filename().string() + ".draft")).generic_string();
}

}  // namespace

std::optional<Value> readDraft(const ServedFolder& folder, const std::string& path) {
  try {
    const std::string file = draftOf(path);
    std::error_code error;
    if (!fs::is_regular_file(folder.resolve(file), error)) return std::nullopt;
    Value scene = parseJson(folder.read(file), file);
    if (scene.isObject()) return scene;
  } catch (const Error&) {
    // Half a file, or one of somebody else.
  }
  return std::nullopt;
}

void writeDraft(const ServedFolder& folder, const std::string& path, const Value& scene) {
  folder.write(draftOf(path), writeJson(scene));
}

void removeDraft(const ServedFolder& folder, const std::string& path) {
  std::error_code ignored;
  fs::remove(folder.resolve(draftOf(path)), ignored);
}

}  // namespace weir::studio
