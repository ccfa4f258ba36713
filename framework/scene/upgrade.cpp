#include "framework/scene/upgrade.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "framework/base/check.h"
#include "framework/base/text.h"
#include "framework/scene/expand.h"
#include "framework/scene/moved_modules.h"
#include "framework/scene/text_tree.h"

namespace weir {

namespace {

std::string written(const Value& value) {
  std::string text = writeJsonLine(value);
  text.pop_back();
  return text;
}

bool isBlank(std::string_view text) {
  return text.find_first_not_of(" \t\r\n") == std::string_view::npos;
}

/// One file's text with the edits that it gets.
class FileText {
 public:
  FileText(std::string file, std::string text)
      : file_(std::move(file)), text_(std::move(text)), tree_(readTextTree(text_)) {}
  FileText(const FileText&) = delete;
  FileText& operator=(const FileText&) = delete;

  struct Found {
    const TextItem* parent;
    std::size_t index;
    const TextItem& item() const { return parent->items[index]; }
  };
  Found find(const Value& value) const {
    const Found found = findIn(tree_, value);
    WEIR_CHECK(found.parent != nullptr);
    return found;
  }

  void rename(const Value& value, const std::string& name) {
    const std::string_view before = find(value).item().name;
    add({offset(before), before.size(), written(name)}, value,
        fmt::format("{} becomes {}", before, written(name)));
  }
  void replace(const Value& value, const Value& other) {
    const std::string_view before = find(value).item().value;
    add({offset(before), before.size(), written(other)}, value,
        fmt::format("{} becomes {}", before, written(other)));
  }
  void insert(const Value& object, const std::string& name, const Value& value) {
    const TextItem& parent = find(object).item();
    const std::string member = written(name) + ": " + written(value);
    const std::string what = member + " is added";
    if (parent.items.empty())
      add({offset(parent.value) + 1, 0, " " + member + " "}, object, what);
    else if (name == "type")  // where people look for it
      add({start(parent.items.front()), 0, member + "," + between(parent)}, object, what);
    else
      append(parent, member, object, what);
  }
  void remove(const TextItem& parent, const std::vector<std::size_t>& indices,
              const std::vector<Value>& values) {
    for (std::size_t k = 0; k < indices.size(); ++k) {
      const TextItem& item = parent.items[indices[k]];
      const std::string what = fmt::format("{} is left out, as it has no effect", item.name);
      add(withoutItem(parent, indices[k], indices), values[k], what);
      if (const std::string_view comma = commaToDrop(parent, indices[k], indices); !comma.empty())
        if (!covered(comma)) add({offset(comma), 1, ""}, values[k], {});
    }
  }

  void addTo(Upgrade& upgrade) {
    if (edits_.empty()) return;
    std::stable_sort(edits_.begin(), edits_.end(),
                     [](const Edit& a, const Edit& b) { return a.edit.offset < b.edit.offset; });
    std::vector<TextEdit> edits;
    for (const Edit& e : edits_) {
      if (!e.what.empty())
        upgrade.changes.push_back(
            fmt::format("{}:{}:{}: {}", printable(file_, 2000), e.line, e.column, printable(e.what, 300)));
      edits.push_back(e.edit);
    }
    upgrade.files.push_back({file_, withEdits(text_, std::move(edits))});
  }

 private:
  struct Edit {
    TextEdit edit;
    int line, column;
    std::string what;
  };

  static std::tuple<std::size_t, std::size_t, const std::string&> key(const Edit& e) {
    return {e.edit.offset, e.edit.bytes, e.edit.text};
  }

  static Found findIn(const TextItem& parent, const Value& value) {
    for (std::size_t i = 0; i < parent.items.size(); ++i) {
      const TextItem& item = parent.items[i];
      if (item.line == value.line && item.column == value.column) return {&parent, i};
      if (const Found found = findIn(item, value); found.parent != nullptr) return found;
    }
    return {nullptr, 0};
  }

  std::size_t offset(std::string_view part) const {
    return static_cast<std::size_t>(part.data() - text_.data());
  }
  std::size_t end(std::string_view part) const { return offset(part) + part.size(); }
  std::size_t start(const TextItem& item) const {
    if (!item.before.empty()) return std::min(offset(item.before.front().text), offset(item.name));
    return offset(item.name);
  }

  /// What separates members on their lines: a line break and spaces, or a space.
  std::string between(const TextItem& parent) const {
    const std::size_t first = start(parent.items.front());
    const std::size_t lineBreak = text_.rfind('\n', first);
    if (lineBreak == std::string::npos || lineBreak < offset(parent.value)) return " ";
    const std::string_view indent = std::string_view(text_).substr(lineBreak, first - lineBreak);
    return isBlank(indent) ? std::string(indent) : " ";
  }

  void append(const TextItem& parent, const std::string& member, const Value& object,
              const std::string& what) {
    const TextItem& last = parent.items.back();
    const std::size_t behind = last.after.empty() ? 0 : end(last.after.back().text);
    if (last.comma.empty()) {
      const bool isFirst = extended_.insert(&parent).second;
      if (isFirst) add({end(last.value), 0, ","}, object, {});
      add({std::max(behind, end(last.value)), 0, (isFirst ? "" : ",") + between(parent) + member}, object,
          what);
    } else {
      add({std::max(behind, end(last.comma)), 0, between(parent) + member + ","}, object, what);
    }
  }

  static bool isAmong(std::size_t index, const std::vector<std::size_t>& indices) {
    return std::find(indices.begin(), indices.end(), index) != indices.end();
  }
  /// Whether an item that stays follows.
  static bool isFollowed(const TextItem& parent, std::size_t index, const std::vector<std::size_t>& gone) {
    for (std::size_t i = index + 1; i < parent.items.size(); ++i)
      if (!isAmong(i, gone)) return true;
    return false;
  }
  /// Its own comma, or the one before it if nothing follows.
  static std::string_view commaToDrop(const TextItem& parent, std::size_t index,
                                      const std::vector<std::size_t>& gone) {
    const bool all = gone.size() == parent.items.size();
    if (all || isFollowed(parent, index, gone)) return parent.items[index].comma;
    return parent.items[index - 1].comma;
  }

  /// Takes away a member with the white space that it leaves, and with its comma if that is next to it.
  TextEdit withoutItem(const TextItem& parent, std::size_t index,
                       const std::vector<std::size_t>& gone) const {
    const TextItem& item = parent.items[index];
    const std::string_view text = text_, comma = commaToDrop(parent, index, gone);
    std::size_t from = offset(item.name), to = end(item.value);
    if (!comma.empty() && offset(comma) >= to && isBlank(text.substr(to, offset(comma) - to)))
      to = end(comma);
    const bool commaBefore = !comma.empty() && end(comma) <= from;
    if (commaBefore && text.substr(end(comma), from - end(comma)).find_first_not_of(' ') == text.npos)
      return {offset(comma), to - offset(comma), ""};
    const std::size_t lineStart = text.rfind('\n', from) + 1,
                      lineEnd = std::min(text.find('\n', to), text.size());
    if (isBlank(text.substr(lineStart, from - lineStart)) && isBlank(text.substr(to, lineEnd - to)) &&
        lineEnd < text.size())
      return {lineStart, lineEnd + 1 - lineStart, ""};
    while (to < text.size() && text[to] == ' ') ++to;
    return {from, to - from, ""};
  }

  bool covered(std::string_view part) const {
    return std::any_of(edits_.begin(), edits_.end(), [&](const Edit& e) {
      return e.edit.offset <= offset(part) && end(part) <= e.edit.offset + e.edit.bytes;
    });
  }

  void add(TextEdit edit, const Value& at, std::string what) {
    const Edit added{std::move(edit), at.line, at.column, std::move(what)};
    const bool known =
        std::any_of(edits_.begin(), edits_.end(), [&](const Edit& e) { return key(e) == key(added); });
    if (!known) edits_.push_back(added);
  }

  std::string file_, text_;
  TextItem tree_;
  std::vector<Edit> edits_;
  std::set<const TextItem*> extended_;  // that got members at their ends
};

class Upgrader {
 public:
  Upgrader(const std::filesystem::path& scene, const Registry& registry, const PluginLoader& loadPlugins)
      : scene_(scene), registry_(registry) {
    std::string text = readTextFile(scene, kLargestSceneFile);
    const Place place{scene.string(), "", scene.parent_path().string()};
    const Value root = parseScene(text, scene.string());
    if (loadPlugins) loadPlugins(scenePlugins(withIncludes(root, place), place));
    std::vector<std::string> warnings;
    buildScene(root, place, registry, {}, warnings);  // throws if it is not valid
    files_.try_emplace(scene.string(), scene.string(), std::move(text));
    const Value plain = expandScene(root, place, {}).plain;
    for (const auto& [name, spec] : plain.find("nodes")->asObject())
      upgradeModules(spec, place / "nodes" / name);
  }

  Upgrade run() {
    Upgrade upgrade;
    for (auto& [name, file] : files_) file.addTo(upgrade);
    return upgrade;
  }

 private:
  void upgradeModules(const Value& spec, const Place& place) {
    const Value* before = spec.find("modules");
    if (before == nullptr) return;
    const std::unique_ptr<Node> node = registry_.createNode(spec.find("type")->asString());
    std::vector<std::string> warnings;
    const Value after =
        withMovedParameters(*before, *node->pipeline(), registry_, place / "modules", warnings);
    for (std::size_t i = 0; i < before->asObject().size(); ++i) {
      const auto& [name, module] = before->asObject()[i];
      checkSame(module, after.asObject()[i].second, place / "modules" / name);
      change(module, after.asObject()[i].second);
    }
  }

  /// Copies of a repeated node, or of what a file that is included twice says, have one text.
  void checkSame(const Value& before, const Value& after, const Place& place) {
    std::string shape = shapeOf(after);
    const auto [first, added] = shapes_.emplace(key(before), shape);
    if (!added && first->second != shape)
      throw place.error(before, "this stands for several modules, which would have to be written differently",
                        "one that is the same for all", "write these modules one by one, then upgrade");
  }
  /// Its names, and the type.
  static std::string shapeOf(const Value& module) {
    std::string shape;
    if (const Value* type = module.find("type")) shape += written(*type);
    if (const Value* params = module.find("params"); params != nullptr && params->isObject())
      for (const auto& [name, value] : params->asObject()) shape += " " + name;
    return shape;
  }

  void change(const Value& before, const Value& after) {
    if (!before.isObject() || !after.isObject()) {
      if (!(before == after)) fileOf(before).replace(before, after);
      return;
    }
    if (!done_.insert(key(before)).second) return;
    std::vector<const Value*> kept;
    for (const auto& [name, value] : after.asObject()) {
      if (const Value* same = before.find(name)) {
        change(*same, value);
        kept.push_back(same);
      } else if (const Value* renamed = renamedTo(value, before, after, kept)) {
        fileOf(*renamed).rename(*renamed, name);
        kept.push_back(renamed);
      } else {
        fileOf(before).insert(before, name, value);
      }
    }
    removeOthers(before, kept);
  }

  /// The member of `before` that is this value and has no such name any more.
  static const Value* renamedTo(const Value& value, const Value& before, const Value& after,
                                const std::vector<const Value*>& kept) {
    for (const auto& [name, member] : before.asObject())
      if (after.find(name) == nullptr && key(member) == key(value) && member == value &&
          std::find(kept.begin(), kept.end(), &member) == kept.end())
        return &member;
    return nullptr;
  }

  void removeOthers(const Value& before, const std::vector<const Value*>& kept) {
    struct Removed {
      FileText* file;
      std::vector<std::size_t> indices;
      std::vector<Value> values;
    };
    std::map<const TextItem*, Removed> removed;
    for (const auto& [name, member] : before.asObject()) {
      if (std::find(kept.begin(), kept.end(), &member) != kept.end()) continue;
      FileText& file = fileOf(member);
      const FileText::Found found = file.find(member);
      Removed& here = removed[found.parent];
      here.file = &file;
      here.indices.push_back(found.index);
      here.values.push_back(member);
    }
    for (const auto& [parent, r] : removed) r.file->remove(*parent, r.indices, r.values);
  }

  using Key = std::tuple<std::string, int, int>;
  static Key key(const Value& v) { return {v.origin ? v.origin->name : "", v.line, v.column}; }

  FileText& fileOf(const Value& v) {
    const std::string name = v.origin ? v.origin->name : scene_.string();
    if (const auto known = files_.find(name); known != files_.end()) return known->second;
    return files_.try_emplace(name, name, readTextFile(name, kLargestSceneFile)).first->second;
  }

  std::filesystem::path scene_;
  const Registry& registry_;
  std::map<std::string, FileText> files_;
  std::map<Key, std::string> shapes_;
  std::set<Key> done_;
};

}  // namespace

Upgrade upgradeOf(const std::filesystem::path& scene, const Registry& registry,
                  const PluginLoader& loadPlugins) {
  return Upgrader(scene, registry, loadPlugins).run();
}

}  // namespace weir
