#include "framework/scene/scene_file.h"

namespace weir {

namespace {

void putUnlessEmpty(Value& object, const std::string& key, Value members) {
  if (!members.asObject().empty()) object[key] = std::move(members);
}

/// A text that begins with '=' would be read as an expression: it is written with two.
Value escaped(Value v) {
  if (v.isString() && v.asString().starts_with('=')) return Value("=" + v.asString());
  if (v.isArray())
    for (Value& item : v.asArray()) item = escaped(std::move(item));
  if (v.isObject())
    for (auto& [name, member] : v.asObject()) member = escaped(std::move(member));
  return v;
}

Value nodeToValue(Node& node) {
  Value spec = Value::object();
  spec["type"] = node.info().type;
  putUnlessEmpty(spec, "params", escaped(node.changedValues()));
  if (node.pipeline() != nullptr) putUnlessEmpty(spec, "modules", escaped(node.pipeline()->changedValues()));
  return spec;
}

}  // namespace

Value sceneToValue(const Scene& scene) {
  Value root = Value::object();
  if (!scene.schema.empty()) root["$schema"] = scene.schema;
  root["weir"] = kSceneVersion;
  if (!scene.title.empty()) root["title"] = scene.title;
  if (!scene.plugins.empty()) root["plugins"] = ParamTraits<std::vector<FilePath>>::toValue(scene.plugins);
  putUnlessEmpty(root, "world", scene.world.changedValues());
  root["nodes"] = Value::object();
  for (const auto& node : scene.graph.nodes()) root["nodes"][node->name()] = nodeToValue(*node);
  if (!scene.graph.links().empty()) {
    root["links"] = Value::array();
    for (const Link& link : scene.graph.links()) root["links"].push(link.text());
  }
  for (const auto& [name, section] : scene.sections)
    putUnlessEmpty(root, name, escaped(section->changedValues()));
  for (const auto& [name, value] : scene.unknownSections) root[name] = escaped(value);
  if (!scene.layout.isNull()) root["layout"] = scene.layout;
  return root;
}

}  // namespace weir
