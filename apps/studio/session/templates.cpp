#include "apps/studio/session/templates.h"

#include <algorithm>
#include <optional>
#include <set>
#include <vector>

#include "apps/studio/server/served_folder.h"
#include "framework/base/error.h"
#include "framework/base/text.h"
#include "framework/scene/scene_file.h"

namespace weir::studio {

namespace fs = std::filesystem;

namespace {

constexpr const char* kFolder = "templates";

std::string textOf(const Value& value, std::string_view name) {
  const Value* v = value.find(name);
  return v != nullptr && v->isString() ? v->asString() : std::string();
}

/// The types that a part of a scene names, of nodes and modules alike.
void collectTypes(const Value& part, std::set<std::string>& types) {
  if (part.isArray())
    for (const Value& item : part.asArray()) collectTypes(item, types);
  if (!part.isObject()) return;
  if (std::string type = textOf(part, "type"); !type.empty()) types.insert(std::move(type));
  for (const auto& [name, inner] : part.asObject()) collectTypes(inner, types);
}

/// What the index says; nothing if there is none.
Value listed(const ServedFolder& scenes) {
  try {
    Value index = parseJson(scenes.read(std::string(kFolder) + "/index.json"), "index.json");
    if (index.isArray()) return index;
  } catch (const Error&) {
    // A folder of somebody's own scenes has none.
  }
  Value all = Value::array();
  for (const ServedFile& file : scenes.list("")) {
    if (file.isFolder || !file.path.ends_with(".json")) continue;
    Value entry = Value::object();
    entry["path"] = file.path;
    all.push(std::move(entry));
  }
  return all;
}

std::optional<Value> templateOf(const ServedFolder& scenes, const Value& entry) {
  try {
    const std::string path = textOf(entry, "path");
    const std::string text = scenes.read(path);
    const Value scene = parseScene(text, path);
    const std::string title = textOf(scene, "title");
    std::set<std::string> types;
    if (const Value* nodes = scene.find("nodes")) collectTypes(*nodes, types);
    std::string thumbnail = fs::path(path).replace_extension(".jpg").generic_string();
    std::replace(thumbnail.begin(), thumbnail.end(), '/', '_');
    std::error_code error;
    const bool hasThumbnail = fs::is_regular_file(thumbnailFile(scenes.root(), thumbnail), error);
    Value v = Value::object();
    v["path"] = path;
    v["title"] = title.empty() ? path : title;
    v["description"] = textOf(entry, "description");
    v["group"] = textOf(entry, "group");
    v["types"] = Value::array();
    for (const std::string& type : types) v["types"].push(type);
    v["bytes"] = static_cast<std::int64_t>(text.size());
    v["thumbnail"] = hasThumbnail ? "/api/thumbnail/" + thumbnail : std::string();
    return v;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

Value templatesIn(const fs::path& folder) {
  Value list = Value::array();
  std::error_code error;
  if (!fs::is_directory(folder, error)) return list;
  const ServedFolder scenes(folder);
  const Value entries = listed(scenes);
  for (const Value& entry : entries.asArray())
    if (auto found = templateOf(scenes, entry)) list.push(std::move(*found));
  return list;
}

fs::path thumbnailFile(const fs::path& folder, const std::string& name) {
  if (name.find('/') != std::string::npos || !name.ends_with(".jpg"))
    throw usageError("there is no thumbnail " + inQuotes(name), "a file name that ends in .jpg");
  return ServedFolder(folder).resolve(std::string(kFolder) + "/" + name);
}

}  // namespace weir::studio
