#include "framework/base/check.h"
#include "framework/scene/expand.h"
#include "framework/scene/scene_file.h"
#include "framework/scene/sections.h"

namespace weir {

namespace {

/// Of a node; of repeated ones, with the index in braces; or a member that is not a node.
constexpr const char* kNodeName =
    R"(^([A-Za-z][A-Za-z0-9_-]{0,99}|[A-Za-z{][^.\s]*\{.*\}.*|\{.*\}.*|\$include)$)";
constexpr const char* kLinkForm = R"(^\s*[^.\s]+\.[^.\s]+\s*->\s*[^.\s]+\.[^.\s]+\s*$)";

using Member = std::pair<std::string, Value>;

Value object(std::vector<Member> members) {
  return Value(
      Value::Object(std::make_move_iterator(members.begin()), std::make_move_iterator(members.end())));
}

Value reference(const std::string& definition) {
  return object({{"$ref", "#/$defs/" + definition}});
}

Value described(Value schema, std::string_view doc) {
  if (!doc.empty()) schema["description"] = doc;
  return schema;
}

/// { if: the member "type" is `type`, then: `schema` }
Value ifType(std::string_view type, Value schema) {
  Value is = object(
      {{"properties", object({{"type", object({{"const", type}})}})}, {"required", Value::Array{"type"}}});
  return object({{"if", std::move(is)}, {"then", std::move(schema)}});
}

Value paramsSchema(std::string reference_) {
  return object({{"properties", object({{"params", reference(std::move(reference_))}})}});
}

/// A module of a family: its own members, and "params" by its type.
Value familySchema(const Registry& registry, const std::string& family) {
  Value types = Value::array(), byType = Value::array();
  for (const auto& [type, entry] : registry.modules()) {
    if (entry.info.family != family) continue;
    types.push(type);
    byType.push(ifType(type, paramsSchema("params." + type)));
  }
  const Value name = object({{"type", "string"}});
  Value schema =
      object({{"type", "object"},
              {"properties",
               object({{"type", described(object({{"enum", std::move(types)}}),
                                          "Replaces the module of this name, or makes a new one.")},
                       {"enabled", described(object({{"type", "boolean"}}), "Whether the module runs.")},
                       {"after", described(name, "The module to stand behind.")},
                       {"before", described(name, "The module to stand before.")},
                       {"params", object({{"type", "object"}})}})},
              {"additionalProperties", false}});
  if (!byType.asArray().empty()) schema["allOf"] = std::move(byType);
  return schema;
}

/// The "modules" of a node: those of its default pipeline need no type.
Value modulesSchema(const PipelineBase& pipeline) {
  const std::string family = "family." + pipeline.family();
  Value defaults = Value::object();
  for (const auto& module : pipeline.modules()) {
    const std::string type(module->info().type);
    Value hasType = object({{"required", Value::Array{"type"}}});
    Value byDefault = object({{"if", std::move(hasType)}, {"else", paramsSchema("params." + type)}});
    defaults[module->name()] =
        object({{"description", "By default a " + type + ": " + std::string(module->info().doc)},
                {"allOf", Value::Array{reference(family), std::move(byDefault)}}});
  }
  Value added =
      object({{"allOf", Value::Array{reference(family), object({{"required", Value::Array{"type"}}})}}});
  return object(
      {{"type", "object"}, {"properties", std::move(defaults)}, {"additionalProperties", std::move(added)}});
}

Value nodeSchema(const Registry& registry, const Registry::NodeType& type) {
  const std::unique_ptr<Node> node = registry.createNode(type.info.type);
  Value members = object({{"type", object({{"const", type.info.type}})}, {"params", node->schema()}});
  if (PipelineBase* pipeline = node->pipeline()) members["modules"] = modulesSchema(*pipeline);
  return object(
      {{"description", type.info.doc}, {"properties", std::move(members)}, {"additionalProperties", false}});
}

Value definitions(const Registry& registry) {
  Value all = Value::object();
  Value types = Value::array(), byType = Value::array();
  for (const auto& [name, type] : registry.nodes()) {
    types.push(name);
    byType.push(ifType(name, reference("node." + name)));
    all["node." + name] = nodeSchema(registry, type);
  }
  Value node = object({{"type", "object"},
                       {"required", Value::Array{"type"}},
                       {"properties", object({{"type", object({{"enum", std::move(types)}})}})}});
  if (!byType.asArray().empty()) node["allOf"] = std::move(byType);
  all["node"] = std::move(node);

  for (const auto& [name, type] : registry.modules()) {
    all["params." + name] = described(registry.createModule(name)->schema(), type.info.doc);
    const std::string family(type.info.family);
    if (all.find("family." + family) == nullptr) all["family." + family] = familySchema(registry, family);
  }
  for (const auto& [name, type] : registry.nodes()) {
    const std::unique_ptr<Node> made = registry.createNode(name);
    if (made->pipeline() == nullptr) continue;
    const std::string& family = made->pipeline()->family();
    if (all.find("family." + family) == nullptr) all["family." + family] = familySchema(registry, family);
    // A default module's type need not be registered: only its node makes it.
    for (const auto& module : made->pipeline()->modules()) {
      const std::string definition = "params." + std::string(module->info().type);
      if (all.find(definition) == nullptr) all[definition] = described(module->schema(), module->info().doc);
    }
  }
  return all;
}

Value rootMembers(const Registry& registry) {
  const Value text = object({{"type", "string"}});
  const auto list = [](Value items) { return object({{"type", "array"}, {"items", std::move(items)}}); };
  Value members =
      object({{"$schema", text},
              {"weir", described(object({{"const", kSceneVersion}}), "The version of the scene format.")},
              {"title", described(text, "What the scene shows.")},
              {"plugins",
               described(list(text), "Libraries to load; relative paths are relative to the scene file.")},
              {"world", described(World().schema(), "What all nodes share.")},
              {"nodes", described(object({{"type", "object"},
                                          {"minProperties", 1},
                                          {"propertyNames", object({{"pattern", kNodeName}})},
                                          {"additionalProperties", reference("node")}}),
                                  "The nodes by name.")},
              {"links", described(list(object({{"type", "string"}, {"pattern", kLinkForm}})),
                                  "Links of the form \"node.output -> node.input\".")},
              {"let", described(object({{"type", "object"},
                                        {"properties", object({})},
                                        {"additionalProperties", object({{"type", "number"}})}}),
                                "Variables for expressions such as \"=spacing*4\".")},
              {"layout", described(object({{"type", "object"}}), "Where an editor shows the nodes.")}});
  for (const std::string& name : sectionNames(registry)) {
    const auto section = registry.sections().find(name);
    members[name] = section == registry.sections().end()
                        ? described(Value::object(), "Ignored: the plugin that reads it is not loaded.")
                        : described(section->second.create()->schema(), section->second.doc);
  }
  return members;
}

/// A list's items, or a node: {"repeat": 5, "as": "i", what: …}.
Value repeatSchema(const char* what, Value repeated) {
  return object(
      {{"type", "object"},
       {"properties",
        object(
            {{"repeat", described(object({{"type", "integer"}, {"minimum", 0}}), "How many copies.")},
             {"as", described(object({{"type", "string"}}), "The name of the index, from 0; i by default.")},
             {what, std::move(repeated)}})},
       {"required", Value::Array{"repeat", what}},
       {"additionalProperties", false}});
}

Value either(Value a, Value b) {
  return object({{"anyOf", Value::Array{std::move(a), std::move(b)}}});
}

void addShorthand(Value& schema);

void addShorthandToEach(Value* schemas) {
  if (schemas == nullptr) return;
  if (schemas->isArray())
    for (Value& each : schemas->asArray()) addShorthand(each);
  else if (schemas->isObject())
    for (auto& [name, each] : schemas->asObject()) addShorthand(each);
}

/// Members that are required may come from an included file.
void addToObject(Value& schema) {
  Value& members = schema["properties"];
  members["note"] = described(object({{"type", "string"}}), "Whatever there is to say; it is ignored.");
  members["$include"] =
      described(object({{"type", "string"}}), "A file whose members are merged below those beside this.");
  const Value* required = schema.find("required");
  if (required == nullptr) return;
  Value all = object({{"required", *required}});
  Value included = object({{"required", Value::Array{"$include"}}});
  std::erase_if(schema.asObject(), [](const auto& member) { return member.first == "required"; });
  WEIR_CHECK(schema.find("anyOf") == nullptr);
  schema["anyOf"] = either(std::move(all), std::move(included))["anyOf"];
}

void addToList(Value& schema) {
  Value items = *schema.find("items");
  schema["items"] = either(std::move(items), reference("repeat"));
  const Value* min = schema.find("minItems");
  if (min == nullptr) return;
  Value enough = object({{"minItems", *min}});
  Value repeated = object({{"contains", object({{"required", Value::Array{"repeat"}}, {"type", "object"}})}});
  std::erase_if(schema.asObject(), [](const auto& member) { return member.first == "minItems"; });
  schema["anyOf"] = either(std::move(enough), std::move(repeated))["anyOf"];
}

/// Lets a schema of plain scenes take expressions, units, notes, included files and repetition. What stands
/// under "if" tells types apart and stays.
void addShorthand(Value& schema) {
  if (!schema.isObject()) return;
  for (const char* one : {"items", "additionalProperties", "then", "else", "propertyNames"})
    if (Value* inner = schema.find(one)) addShorthand(*inner);
  for (const char* many : {"properties", "$defs", "anyOf", "allOf", "prefixItems"})
    addShorthandToEach(schema.find(many));
  const Value type = schema.find("type") != nullptr ? *schema.find("type") : Value();
  if (type == Value("number") || type == Value("integer")) {
    schema["type"] = Value::Array{type, "string"};
    schema["pattern"] = R"(^(=[^=]|[-+]?[.]?[0-9][0-9.eE+-]*\s*[^0-9.eE+\s-]))";  // "=2*spacing", "5 cm"
  }
  const bool isClosed = schema.find("additionalProperties") != nullptr;
  if (schema.find("properties") != nullptr && isClosed)
    addToObject(schema);
  else if (schema.find("required") != nullptr && schema.find("allOf") != nullptr)
    addToObject(schema);
  if (schema.find("items") != nullptr && schema.find("maxItems") == nullptr) addToList(schema);
}

}  // namespace

Value withShorthand(Value schema) {
  addShorthand(schema);
  return schema;
}

Value sceneSchema(const Registry& registry) {
  Value schema = object({{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                         {"title", "Weir scene"},
                         {"type", "object"},
                         {"required", Value::Array{"weir", "nodes"}},
                         {"properties", rootMembers(registry)},
                         {"additionalProperties", false},
                         {"$defs", definitions(registry)}});
  addShorthand(schema);
  schema["$defs"]["repeat"] = repeatSchema("item", object({}));
  Value repeatedNode = repeatSchema("node", reference("node"));
  addShorthand(repeatedNode);
  addShorthand(schema["$defs"]["repeat"]);
  Value& nodes = schema["properties"]["nodes"];
  nodes["additionalProperties"] = either(reference("node"), std::move(repeatedNode));
  addToObject(nodes);
  return schema;
}

}  // namespace weir
