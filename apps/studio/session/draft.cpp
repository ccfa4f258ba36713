#include "apps/studio/session/draft.h"

#include <sys/stat.h>

#include <filesystem>

#include "framework/base/error.h"
#include "framework/base/file_output.h"
#include "framework/scene/scene_file.h"

namespace weir::studio {

namespace fs = std::filesystem;

namespace {

constexpr int kOldDrafts = 3;

/// Where the draft of a scene is, or an older one.
fs::path draftOf(const ServedFolder& folder, const std::string& path, int age = 0) {
  const fs::path scene = folder.resolve(path.empty() ? kUntitled : path);
  const std::string name = "." + scene.filename().string() + ".draft";
  return scene.parent_path() / (age == 0 ? name : name + "." + std::to_string(age));
}

}  // namespace

std::optional<Draft> readDraft(const ServedFolder& folder, const std::string& path) {
  try {
    const fs::path file = draftOf(folder, path);
    struct stat found {};
    // A link might lead anywhere.
    if (::lstat(file.c_str(), &found) != 0 || !S_ISREG(found.st_mode)) return std::nullopt;
    const std::string name = file.filename().string();
    Draft draft{parseJson(readRegularFile(file, name), name), found.st_mtim.tv_sec};
    if (draft.scene.isObject()) return draft;
  } catch (const Error&) {
    // Half a file, or one of somebody else.
  }
  return std::nullopt;
}

void writeDraft(const ServedFolder& folder, const std::string& path, const Value& scene) {
  writeFileAtomically(draftOf(folder, path), writeJson(scene));
}

void removeDraft(const ServedFolder& folder, const std::string& path) {
  std::error_code ignored;
  fs::remove(draftOf(folder, path), ignored);
}

void keepOldDraft(const ServedFolder& folder, const std::string& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(draftOf(folder, path), ignored)) return;
  for (int age = kOldDrafts - 1; age >= 0; --age)
    fs::rename(draftOf(folder, path, age), draftOf(folder, path, age + 1), ignored);
}

}  // namespace weir::studio
