#include <fmt/format.h>

#include <algorithm>

#include "framework/base/text.h"
#include "framework/scene/expand.h"
#include "framework/scene/moved_modules.h"
#include "framework/scene/scene_file.h"
#include "framework/scene/sections.h"

namespace weir {

namespace {

/// Refuses members of an object that are not among `known`.
void checkKeys(const Value& object, const Place& place, const std::vector<std::string>& known,
               const std::string& what) {
  for (const auto& [key, value] : object.asObject())
    if (std::find(known.begin(), known.end(), key) == known.end())
      throw(place / key)
          .error(value, what + " has no member " + inQuotes(key), joinNames(known), didYouMean(key, known));
}

/// The member if it is there; its kind is checked by `is`.
const Value* optionalMember(const Value& object, const Place& place, const char* key,
                            bool (Value::*is)() const, const char* allowed) {
  const Value* member = object.find(key);
  if (member != nullptr && !(member->*is)())
    throw(place / key).error(*member, "found " + member->brief(), allowed);
  return member;
}

void checkVersion(const Value& root, const Place& place) {
  const std::string allowed = fmt::format("\"weir\": {}", kSceneVersion);
  const Value* version = root.find("weir");
  if (version == nullptr)
    throw place.error(root, "the scene does not say its version", allowed,
                      "every scene has this member; without it the file may be something else");
  const Place here = place / "weir";
  if (!version->isInt() || version->asInt() < 1)
    throw here.error(*version, "found " + version->brief() + " as the version of the scene", allowed);
  if (version->asInt() > kSceneVersion)
    throw here.error(
        *version,
        fmt::format("the scene is of version {}, which is newer than this program", version->asInt()),
        fmt::format("versions up to {}", kSceneVersion), "a newer Weir reads it");
}

std::vector<std::string> rootKeys(const Registry& registry) {
  std::vector<std::string> keys{"weir", "title", "world", "nodes", "links", "plugins", "layout", "$schema"};
  for (const std::string& section : sectionNames(registry)) keys.push_back(section);
  return keys;
}

class Builder {
 public:
  Builder(Value root, const Place& place, const Registry& registry, std::vector<std::string>& warnings)
      : root_(std::move(root)),
        place_(place),
        registry_(registry),
        warnings_(warnings),
        scene_(std::make_unique<Scene>()) {}

  std::unique_ptr<Scene> build() {
    if (!root_.isObject())
      throw place_.error(root_, "found " + root_.brief() + " as the whole scene",
                         "an object: { \"weir\": 1, … }");
    checkVersion(root_, place_);
    checkKeys(root_, place_, rootKeys(registry_), "a scene");
    scene_->file = place_.file;
    readHead();
    readSections();
    readNodes();
    readLinks();
    checkRequiredInputs();
    return std::move(scene_);
  }

 private:
  void readHead() {
    if (const Value* title = optionalMember(root_, place_, "title", &Value::isString, "a text"))
      scene_->title = title->asString();
    if (const Value* schema = optionalMember(root_, place_, "$schema", &Value::isString, "an address"))
      scene_->schema = schema->asString();
    if (const Value* layout = optionalMember(root_, place_, "layout", &Value::isObject, "an object"))
      scene_->layout = *layout;
    scene_->plugins = scenePlugins(root_, place_);
  }

  /// Assigns the member `key` of the root, or nothing if it is not there, so that defaults are validated too.
  void assignSection(Configurable& section, const std::string& key) {
    static const Value kNothing = Value::object();
    const Value* value = root_.find(key);
    section.assignAll(value != nullptr ? *value : kNothing, place_ / key);
  }

  void readSections() {
    assignSection(scene_->world, "world");
    for (const std::string& name : sectionNames(registry_)) {
      const auto type = registry_.sections().find(name);
      if (type != registry_.sections().end()) {
        scene_->sections[name] = registry_.createSection(name);
        const auto where = [&] {
          return hookText("section " + inQuotes(name), "validate", type->second.source);
        };
        const auto assign = [&] { assignSection(*scene_->sections[name], name); };
        callGuarded(type->second.source, where, assign, /*filesSayEnough=*/true);
      } else if (const Value* value = root_.find(name)) {
        scene_->unknownSections[name] = *value;
        const Error warning =
            (place_ / name)
                .error(*value, "the section is ignored, because the plugin that reads it is not loaded");
        warnings_.emplace_back(warning.what());
      }
    }
  }

  void readNodes() {
    constexpr const char* kAllowed = "an object of nodes by name, with at least one node";
    const Value* nodes = optionalMember(root_, place_, "nodes", &Value::isObject, kAllowed);
    if (nodes == nullptr) throw place_.error(root_, "the scene has no \"nodes\"", kAllowed);
    const Place here = place_ / "nodes";
    if (nodes->asObject().empty()) throw here.error(*nodes, "the scene has no nodes", kAllowed);
    if (nodes->asObject().size() > kMaxNodes)
      throw here.error(*nodes, fmt::format("the scene has {} nodes", nodes->asObject().size()),
                       fmt::format("at most {}", kMaxNodes));
    for (const auto& [name, spec] : nodes->asObject()) {
      try {
        readNode(name, spec, here / name);
      } catch (Error& e) {
        throw e.at((here / name).of(spec)).inNode(name);
      }
    }
  }

  void readNode(const std::string& name, const Value& spec, const Place& place) {
    if (!spec.isObject()) throw place.error(spec, "found " + spec.brief(), "an object that describes a node");
    checkKeys(spec, place, {"type", "params", "modules"}, "a node");
    if (registry_.sections().contains(name))
      throw place.error(spec, inQuotes(name) + " is the name of a section of scenes",
                        "another name for the node");
    const Value* type = optionalMember(spec, place, "type", &Value::isString, "the name of a node type");
    if (type == nullptr) throw place.error(spec, "the node has no \"type\"", joinNames(nodeTypes()));
    Node& node = createNode(*type, name, place);
    static const Value kNothing = Value::object();
    const Value* params = spec.find("params");
    const auto where = [&] { return hookText("", "validate", node.source()); };
    const auto assign = [&] { node.assignAll(params != nullptr ? *params : kNothing, place / "params"); };
    callGuarded(node.source(), where, assign, /*filesSayEnough=*/true);
    if (const Value* modules = spec.find("modules")) {
      if (node.pipeline() == nullptr)
        throw(place / "modules")
            .error(*modules, "a " + type->asString() + " has no modules", "no \"modules\"");
      const Place here = place / "modules";
      node.pipeline()->assign(withMovedParameters(*modules, *node.pipeline(), registry_, here, warnings_),
                              registry_, here);
    }
    if (node.pipeline() != nullptr) validateModules(node, place / "modules");
  }

  std::vector<std::string> nodeTypes() const {
    std::vector<std::string> types;
    for (const auto& [type, entry] : registry_.nodes()) types.push_back(type);
    return types;
  }

  Node& createNode(const Value& type, const std::string& name, const Place& place) {
    std::unique_ptr<Node> node;
    try {
      node = registry_.createNode(type.asString());
    } catch (Error& e) {
      throw e.at((place / "type").of(type));
    }
    return scene_->graph.add(std::move(node), name);
  }

  void validateModules(Node& node, const Place& place) {
    for (const auto& module : node.pipeline()->modules()) {
      try {
        PipelineBase::call(*module, "validate", [&] { module->validate(); });
      } catch (Error& e) {
        throw e.at({.file = place.file, .pointer = (place / module->name()).pointer});
      }
    }
  }

  void readLinks() {
    constexpr const char* kAllowed = "a list of links of the form \"node.output -> node.input\"";
    const Value* links = optionalMember(root_, place_, "links", &Value::isArray, kAllowed);
    if (links == nullptr) return;
    const Place here = place_ / "links";
    const Value::Array& all = links->asArray();
    if (all.size() > kMaxLinks)
      throw here.error(*links, fmt::format("the scene has {} links", all.size()),
                       fmt::format("at most {}", kMaxLinks));
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!all[i].isString())
        throw(here / i).error(all[i], "found " + all[i].brief(),
                              "a link of the form \"node.output -> node.input\"");
      try {
        scene_->graph.link(SceneGraph::parseLink(all[i].asString()));
      } catch (Error& e) {
        throw e.at((here / i).of(all[i]));
      }
    }
  }

  void checkRequiredInputs() {
    try {
      scene_->graph.validate();
    } catch (Error& e) {
      const Place nodes = place_ / "nodes";
      const std::string& name = e.location().node;
      const Value* spec = root_.find("nodes")->find(name);
      throw spec != nullptr ? e.at((nodes / name).of(*spec)) : e;
    }
  }

  const Value root_;
  const Place& place_;
  const Registry& registry_;
  std::vector<std::string>& warnings_;
  std::unique_ptr<Scene> scene_;
};

}  // namespace

std::vector<FilePath> scenePlugins(const Value& root, const Place& place) {
  const Value* plugins = root.find("plugins");
  if (plugins == nullptr) return {};
  const Place here = place / "plugins";
  auto files = ParamTraits<std::vector<FilePath>>::fromValue(*plugins, {}, here);
  for (std::size_t i = 0; i < files.size(); ++i)
    if (files[i].empty())
      throw(here / i).error(plugins->asArray()[i], "found an empty path", "the path of a plugin's library");
  return files;
}

std::unique_ptr<Scene> buildScene(const Value& root, const Place& place, const Registry& registry,
                                  const std::vector<Override>& overrides,
                                  std::vector<std::string>& warnings) {
  ExpandedScene expanded = expandScene(root, place, overrides);
  return Builder(applyOverrides(std::move(expanded.plain), registry, expanded.overrides), place, registry,
                 warnings)
      .build();
}

std::string textToKeep(std::string text, const Value& root, const Scene& scene) {
  return writtenForm(text, root).isPlain() ? std::move(text) : writeJson(sceneToValue(scene));
}

std::unique_ptr<Scene> loadScene(const std::filesystem::path& path, const Registry& registry,
                                 const std::vector<Override>& overrides, std::vector<std::string>& warnings,
                                 const PluginLoader& loadPlugins) {
  std::string text = readTextFile(path, kLargestSceneFile);
  const Place place{path.string(), "", path.parent_path().string()};
  const Value root = parseScene(text, path.string());
  if (loadPlugins) loadPlugins(scenePlugins(withIncludes(root, place), place));
  std::unique_ptr<Scene> scene = buildScene(root, place, registry, overrides, warnings);
  scene->text = textToKeep(std::move(text), root, *scene);
  return scene;
}

}  // namespace weir
