#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <unordered_map>

#include "framework/base/text.h"
#include "framework/scene/scene_file.h"

namespace weir {

namespace {

namespace fs = std::filesystem;

constexpr const char* kKey = "$include";
constexpr int kMaxIncludes = 200;  // of one scene, so that files that include each other twice end
constexpr const char* kAllowed = "the path of a file in the folder of the scene or below it";

/// Puts into `target` what `below` has and it has not; objects in both are merged.
void mergeBelow(Value& target, Value below) {
  if (!target.isObject() || !below.isObject()) return;
  Value::Object& members = target.asObject();
  std::unordered_map<std::string, std::size_t> known;
  for (std::size_t i = 0; i < members.size(); ++i) known.emplace(members[i].first, i);
  for (auto& [name, member] : below.asObject()) {
    if (const auto there = known.find(name); there != known.end())
      mergeBelow(members[there->second].second, std::move(member));
    else
      members.emplace_back(std::move(name), std::move(member));
  }
}

class Includer {
 public:
  explicit Includer(const Place& scene) : scene_(scene), folder_(scene.folder.empty() ? "." : scene.folder) {
    open_.push_back(fs::path(scene.file).filename());
  }

  /// `folder` is that of the file that v stands in, relative to the scene's.
  void resolve(Value& v, const Place& place, const fs::path& folder, int depth) {
    if (depth > kDeepestNesting)
      throw place.error(v, "files are included more deeply than can be read",
                        fmt::format("a depth of at most {}", kDeepestNesting));
    if (v.isArray()) {
      for (std::size_t i = 0; i < v.asArray().size(); ++i)
        resolve(v.asArray()[i], place / i, folder, depth + 1);
    } else if (v.isObject()) {
      for (auto& [name, member] : v.asObject())
        if (name != kKey) resolve(member, place / name, folder, depth + 1);
      if (v.find(kKey) != nullptr) include(v, place, folder, depth);
    }
  }

 private:
  void include(Value& v, const Place& place, const fs::path& folder, int depth) {
    const Value name = *v.find(kKey);
    const Place here = place / kKey;
    const fs::path path = pathOf(name, here, folder);
    Value included = read(name, here, path);
    open_.push_back(path);
    resolve(included, Place{scene_.file, "", scene_.folder}, path.parent_path(), depth + 1);
    open_.pop_back();
    std::erase_if(v.asObject(), [](const auto& member) { return member.first == kKey; });
    mergeBelow(v, std::move(included));
  }

  /// Relative to the scene's folder, which it may not leave: a scene from elsewhere reads nothing else.
  fs::path pathOf(const Value& name, const Place& here, const fs::path& folder) const {
    if (!name.isString() || name.asString().empty() || name.asString().find('\0') != std::string::npos)
      throw here.error(name, "found " + name.brief(), kAllowed);
    const fs::path path = (folder / fs::path(name.asString())).lexically_normal();
    if (path.is_absolute() || *path.begin() == "..")
      throw here.error(name, "the file " + inQuotes(name.asString()) + " is outside the folder of the scene",
                       kAllowed);
    std::error_code absent, error;
    const fs::path real = fs::canonical(folder_ / path, absent);
    const fs::path inside = real.lexically_relative(fs::canonical(folder_, error));
    if (!absent && (inside.empty() || *inside.begin() == ".."))
      throw here.error(
          name, "the file " + inQuotes(name.asString()) + " leads outside the folder of the scene", kAllowed);
    return path;
  }

  Value read(const Value& name, const Place& here, const fs::path& path) {
    if (const auto found = std::find(open_.begin(), open_.end(), path); found != open_.end()) {
      std::vector<std::string> chain;
      for (auto file = found; file != open_.end(); ++file) chain.push_back(printable(file->string()));
      chain.push_back(printable(path.string()));
      throw here.error(name, "files include each other: " + fmt::format("{}", fmt::join(chain, " -> ")),
                       "no cycle");
    }
    if (++count_ > kMaxIncludes)
      throw here.error(name, "the scene includes too many files", fmt::format("at most {}", kMaxIncludes));
    std::error_code error;
    if (!fs::is_regular_file(folder_ / path, error))
      throw here.error(name, "there is no file " + inQuotes(name.asString()), kAllowed);
    const std::string shown = (fs::path(scene_.file).parent_path() / path).string();
    const std::string text =
        readTextFile(folder_ / path, kLargestSceneFile - std::min(bytes_, kLargestSceneFile));
    bytes_ += text.size();
    Value value = parseScene(text, shown);
    const std::string folder = (fs::path(scene_.folder) / path.parent_path()).string();
    setOrigin(value, std::make_shared<const ValueOrigin>(ValueOrigin{shown, folder}));
    if (!value.isObject())
      throw here.error(name, "the file " + inQuotes(name.asString()) + " holds " + value.brief(),
                       "an object");
    return value;
  }

  static void setOrigin(Value& v, const std::shared_ptr<const ValueOrigin>& origin) {
    v.origin = origin;
    if (v.isArray())
      for (Value& item : v.asArray()) setOrigin(item, origin);
    else if (v.isObject())
      for (auto& [name, member] : v.asObject()) setOrigin(member, origin);
  }

  const Place& scene_;
  fs::path folder_;
  std::vector<fs::path> open_;
  int count_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace

Value withIncludes(Value root, const Place& place) {
  Includer(place).resolve(root, place, {}, 0);
  return root;
}

}  // namespace weir
