#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "framework/base/text.h"
#include "framework/scene/scene_file.h"
#include "framework/scene/sections.h"

namespace weir {

namespace {

constexpr const char* kForms =
    "NODE.PARAM=VALUE, NODE.MODULE.PARAM=VALUE, world.PARAM=VALUE, render.PARAM=VALUE, let.NAME=VALUE or "
    "title=TEXT";

void setOrigin(Value& v, const std::shared_ptr<const ValueOrigin>& origin) {
  v.origin = origin;
  v.line = v.column = 0;
  if (v.isArray())
    for (Value& item : v.asArray()) setOrigin(item, origin);
  else if (v.isObject())
    for (auto& [name, member] : v.asObject()) setOrigin(member, origin);
}

/// JSON where it is JSON, otherwise the text itself.
Value readOverrideValue(std::string_view text, const std::string& option) {
  const auto first = text.find_first_not_of(" \t");
  const bool meantAsJson =
      first != std::string_view::npos && std::string_view("[{\"").find(text[first]) != std::string_view::npos;
  try {
    return parseJson(text, option);
  } catch (const Error& e) {
    if (meantAsJson)
      throw usageError(option + ": " + e.message(), e.allowed(),
                       e.hint().empty() ? "a shell needs single quotes around it" : e.hint());
    return Value(text);
  }
}

}  // namespace

Override parseOverride(std::string_view text) {
  const std::string option = "--set " + printable(text, 200);
  if (!isUtf8(text)) throw usageError(option + " is not UTF-8 text", kForms);
  const auto equals = text.find('=');
  if (equals == std::string_view::npos) throw usageError(option + " has no '='", kForms);
  Override result;
  std::string_view path = text.substr(0, equals);
  for (bool more = true; more;) {
    const auto dot = path.find('.');
    more = dot != std::string_view::npos;
    result.path.emplace_back(path.substr(0, dot));
    if (result.path.back().empty()) throw usageError(option + " has an empty name before '='", kForms);
    if (more) path.remove_prefix(dot + 1);
  }
  if (result.path.size() == 1 && result.path[0] != "title")
    throw usageError(
        option + " needs two names before '=', with a dot between, and has " + inQuotes(result.path[0]),
        kForms);
  if (result.path.size() > kDeepestNesting) throw usageError(option + " has too many parts", kForms);
  result.value = readOverrideValue(text.substr(equals + 1), option);
  std::error_code ignored;
  const std::string folder = std::filesystem::current_path(ignored).string();
  setOrigin(result.value, std::make_shared<const ValueOrigin>(ValueOrigin{option, folder}));
  return result;
}

namespace {

using Path = std::vector<std::string>;

Error overrideError(const Override& o, std::string message, std::string allowed, std::string hint = {}) {
  return Place{}.error(o.value, std::move(message), std::move(allowed), std::move(hint));
}

/// The member or element that `key` names; a missing member is made.
Value& child(Value& parent, const std::string& key, const Override& o) {
  if (parent.isArray()) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
    if (error == std::errc() && end == key.data() + key.size() && index < parent.asArray().size())
      return parent.asArray()[index];
    const std::size_t size = parent.asArray().size();
    throw overrideError(o, "the list has no element " + inQuotes(key),
                        size == 0 ? "nothing: it is empty" : fmt::format("0 to {}", size - 1));
  }
  if (!parent.isObject())
    throw overrideError(o, inQuotes(key) + " cannot be set in what is " + parent.brief() + " in the file",
                        "a path to a member of an object");
  if (parent.find(key) == nullptr) {
    Value made;
    made.line = parent.line;
    made.column = parent.column;
    parent[key] = std::move(made);
  }
  return parent[key];
}

void put(Value& root, const Path& path, const Override& o) {
  Value* at = &root;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const bool isNew = at->isObject() && at->find(path[i]) == nullptr;
    Value& next = child(*at, path[i], o);
    if (isNew && i + 1 < path.size()) {
      Value object = Value::object();
      object.line = at->line;
      object.column = at->column;
      next = std::move(object);
    }
    at = &next;
  }
  *at = o.value;
}

/// Modules of the node by name: of its default pipeline, and those that the scene adds.
std::vector<std::string> moduleNames(Node& node, const Value& spec) {
  std::vector<std::string> names;
  if (node.pipeline() != nullptr) names = node.pipeline()->names();
  if (const Value* modules = spec.find("modules"); modules != nullptr && modules->isObject())
    for (const auto& [name, module] : modules->asObject())
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

/// Where in the node's spec NODE.a.b… stands: in "params", or in the "params" of module a, or, for its type
/// and whether it is enabled, in the module itself.
Path pathInNode(const Override& o, const Value& spec, const Registry& registry) {
  Path rest(o.path.begin() + 1, o.path.end());
  const Value* type = spec.find("type");
  const bool known = type != nullptr && type->isString() && registry.nodes().contains(type->asString());
  if (rest.size() > 1 && known) {  // building the scene reports a type that is not known
    const std::unique_ptr<Node> node = registry.createNode(type->asString());
    if (node->findProperty(rest[0]) == nullptr) {
      std::vector<std::string> names = moduleNames(*node, spec);
      if (std::find(names.begin(), names.end(), rest[0]) == names.end()) {
        for (const Property* property : node->properties())
          if (property->group() != nullptr) names.push_back(property->name());
        throw overrideError(
            o, inQuotes(o.path[0]) + " (" + type->asString() + ") has no module " + inQuotes(rest[0]),
            names.empty() ? "nothing: it has no modules" : joinNames(names), didYouMean(rest[0], names));
      }
      const bool ofModuleItself = rest.size() == 2 && (rest[1] == "type" || rest[1] == "enabled");
      rest.insert(rest.begin(), "modules");
      if (!ofModuleItself) rest.insert(rest.begin() + 2, "params");
      return rest;
    }
  }
  rest.insert(rest.begin(), "params");
  return rest;
}

Path pathInScene(const Override& o, const Value& root, const Registry& registry) {
  const std::string& first = o.path[0];
  if (first == "title" || first == "world" || isSectionName(first, registry)) {
    if (first == "title" && o.path.size() > 1)
      throw overrideError(o, "the title has no parameters", "title=TEXT");
    return o.path;
  }
  const Value* nodes = root.find("nodes");
  const Value* spec = nodes != nullptr ? nodes->find(first) : nullptr;
  if (spec == nullptr) {
    std::vector<std::string> names;
    if (nodes != nullptr && nodes->isObject())
      for (const auto& [name, node] : nodes->asObject()) names.push_back(printable(name));
    names.push_back("world");
    for (const std::string& section : sectionNames(registry)) names.push_back(section);
    throw overrideError(o, "the scene has no node " + inQuotes(first), joinNames(names),
                        didYouMean(first, names));
  }
  Path path{"nodes", first};
  for (std::string& part : pathInNode(o, *spec, registry)) path.push_back(std::move(part));
  return path;
}

}  // namespace

Value applyOverrides(Value root, const Registry& registry, const std::vector<Override>& overrides) {
  if (!root.isObject()) return root;  // building the scene reports it
  for (const Override& o : overrides) put(root, pathInScene(o, root, registry), o);
  return root;
}

}  // namespace weir
