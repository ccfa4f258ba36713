#include "apps/weir/installed_scenes.h"

#include <algorithm>
#include <cctype>
#include <tuple>

#include "apps/weir/program.h"
#include "framework/base/text.h"

namespace weir::app {

namespace fs = std::filesystem;

namespace {

constexpr const char* kIndex = "templates/index.json";

bool mayBeName(const std::string& text) {
  const auto allowed = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '/';
  };
  return !text.empty() && text.front() != '/' && std::all_of(text.begin(), text.end(), allowed);
}

/// The name whose last part is the given text, or one that is spelled alike.
std::string suggestionFor(const std::string& name) {
  const std::vector<std::string> names = installedScenes();
  for (const std::string& other : names)
    if (other.ends_with("/" + name)) return "did you mean " + inQuotes(other) + "?";
  return didYouMean(name, names);
}

}  // namespace

fs::path sceneFolder() {
  return dataFolder() / "scenes";
}

std::vector<std::string> installedScenes() {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::recursive_directory_iterator at(sceneFolder(), error), end; !error && at != end;
       at.increment(error))
    if (at->path().extension() == ".json") {
      const std::string name = at->path().lexically_relative(sceneFolder()).replace_extension().string();
      if (name + ".json" != kIndex && mayBeName(name)) names.push_back(name);
    }
  const auto key = [](const std::string& name) {
    return std::tuple(name.find('/') != std::string::npos, name);
  };
  std::sort(names.begin(), names.end(),
            [&](const std::string& a, const std::string& b) { return key(a) < key(b); });
  return names;
}

fs::path installedScene(const std::string& name) {
  const std::vector<std::string> names = installedScenes();
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw usageError("there is no scene " + inQuotes(name), "a name that 'weir scenes' lists",
                     suggestionFor(name));
  return sceneFolder() / (name + ".json");
}

std::string descriptionOf(const std::string& name) {
  const fs::path file = sceneFolder() / kIndex;
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return {};
  const Value index = parseJson(readTextFile(file, kLargestSceneFile), file.string());
  if (!index.isArray()) return {};
  for (const Value& entry : index.asArray()) {
    const Value *path = entry.find("path"), *description = entry.find("description");
    if (path != nullptr && description != nullptr && *path == Value(name + ".json") &&
        description->isString())
      return description->asString();
  }
  return {};
}

std::string sceneFile(const std::string& given) {
  std::error_code error;
  if (!mayBeName(given) || fs::exists(given, error) || error) return given;
  const std::vector<std::string> names = installedScenes();
  if (std::find(names.begin(), names.end(), given) != names.end()) return installedScene(given).string();
  const std::string withEnding = given + ".json";
  throw ioError(
      "there is no file " + inQuotes(given) + ", and no scene of this name comes with Weir",
      "a scene file, or a name that 'weir scenes' lists",
      fs::exists(withEnding, error) ? "did you mean " + inQuotes(withEnding) + "?" : suggestionFor(given));
}

}  // namespace weir::app
