#include "apps/weir/sweep/point_folder.h"

#include <fmt/format.h>

#include <system_error>
#include <vector>

#include "framework/base/build_info.h"
#include "framework/base/digest.h"
#include "framework/base/error.h"
#include "framework/base/file_output.h"
#include "framework/base/text.h"
#include "framework/run/checkpoint.h"
#include "framework/scene/scene_file.h"

namespace weir::app {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLargestRecord = std::size_t{64} << 20;

/// What a file of ours holds; none if it is missing or damaged.
std::optional<Value> readRecord(const fs::path& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return std::nullopt;
  try {
    Value value = parseJson(readTextFile(file, kLargestRecord), file.string());
    if (value.isObject()) return value;
  } catch (const Error&) {
  }
  return std::nullopt;
}

void removeFile(const fs::path& file) {
  std::error_code error;
  fs::remove(file, error);
  if (error) throw ioError("cannot remove the file: " + error.message()).at({.file = file.string()});
}

/// Adds the file that a text may name, relative to a folder.
void addFile(const std::string& text, const fs::path& folder, Value& files) {
  constexpr std::size_t kLongestPath = 4096;
  std::error_code ignored;
  const fs::path file = folder / text;
  if (text.empty() || text.size() > kLongestPath || !fs::is_regular_file(file, ignored)) return;
  files[text] = static_cast<std::int64_t>(digestOfFile(file).digest);
}

/// Adds all files that strings of the value name.
void addFiles(const Value& value, const fs::path& folder, Value& files) {
  if (value.isString()) addFile(value.asString(), folder, files);
  if (value.isArray())
    for (const Value& item : value.asArray()) addFiles(item, folder, files);
  if (value.isObject())
    for (const auto& [name, member] : value.asObject()) addFiles(member, folder, files);
}

std::int64_t digestOf(const Value& value) {
  return Digest().addText(writeJson(value)).value();
}

/// What is another now, in words.
std::string differences(const Value& before, const Value& now) {
  std::vector<std::string> names;
  for (const auto& [key, name] : {std::pair{"version", "the version of Weir"},
                                  {"scene", "the scene"},
                                  {"options", "the options behind '--'"},
                                  {"files", "a file that the scene names"},
                                  {"set", "the parameters"}}) {
    const Value *left = before.find(key), *right = now.find(key);
    if (left == nullptr || right == nullptr || !(*left == *right)) names.emplace_back(name);
  }
  return joinNames(names, " and ");
}

}  // namespace

std::string_view nameOf(PointState state) {
  return state == PointState::kDone ? "done" : state == PointState::kFailed ? "failed" : "open";
}

std::optional<Value> PointFolder::statistics() const {
  std::optional<Value> statistics = readRecord(stats());
  const Value* end = statistics ? statistics->find("end") : nullptr;
  if (end == nullptr || !(*end == Value("finished"))) return std::nullopt;
  return statistics;
}

std::optional<PointError> PointFolder::error() const {
  const std::optional<Value> record = readRecord(errorFile());
  const Value *code = record ? record->find("code") : nullptr,
              *text = record ? record->find("error") : nullptr;
  if (code == nullptr || text == nullptr || !code->isInt() || !text->isString()) return std::nullopt;
  return PointError{static_cast<int>(code->asInt()), text->asString()};
}

PointState PointFolder::state() const {
  if (error()) return PointState::kFailed;
  return statistics() ? PointState::kDone : PointState::kOpen;
}

void PointFolder::checkIdentity(const Value& identity) const {
  const std::optional<Value> before = readRecord(identityFile());
  if (!before || *before == identity) return;
  throw ioError(fmt::format("the folder holds results of another sweep: {} changed since",
                            differences(*before, identity)),
                "the same scene, files, options and version", "take another --out, or remove the folder")
      .at({.file = folder_.string()});
}

void PointFolder::begin(const Value& identity) const {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw ioError("cannot make the folder: " + error.message()).at({.file = folder_.string()});
  writeFileAtomically(identityFile(), writeJson(identity));
  removeFile(errorFile());
}

void PointFolder::keepError(const PointError& error) const {
  Value record = Value::object();
  record["code"] = error.code;
  record["error"] = error.text;
  writeFileAtomically(errorFile(), writeJson(record));
}

void PointFolder::finish() const {
  removeFile(Checkpoints::previousOf(checkpoint()));
  removeFile(checkpoint());
}

SweepIdentity::SweepIdentity(const fs::path& scene, const std::vector<std::string>& options)
    : shared_(Value::object()), sceneFolder_(scene.parent_path()) {
  const Value root = withIncludes(parseScene(readTextFile(scene, kLargestSceneFile), scene.string()),
                                  Place{scene.string(), "", sceneFolder_.string()});
  shared_["version"] = version();
  shared_["scene"] = digestOf(root);
  Value given = Value::array();
  for (const std::string& option : options) given.push(option);
  shared_["options"] = std::move(given);
  shared_["files"] = Value::object();
  addFiles(root, sceneFolder_, shared_["files"]);
}

Value SweepIdentity::of(const Point& point) const {
  Value identity = shared_;
  identity["set"] = Value::object();
  for (const Setting& setting : point) {
    identity["set"][setting.name] = setting.value;
    addFiles(parseOverride(setting.name + "=" + setting.value).value, fs::path(), identity["files"]);
  }
  return identity;
}

}  // namespace weir::app
