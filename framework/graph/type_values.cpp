#include "framework/graph/type_values.h"

#include <cmath>

#include "framework/base/text.h"

namespace weir {

namespace {

/// What the elements of a list are: "color", "float", "int" or "string"; empty where they are none of these.
std::string elementKind(const Property& list) {
  const Value schema = list.schema();
  const Value* items = schema.find("items");
  // A list that may be left out is one of two alternatives.
  if (const Value* either = schema.find("anyOf"); items == nullptr && either != nullptr)
    items = either->asArray().front().find("items");
  if (items == nullptr) return {};
  if (*items == ParamTraits<Color>::schema({})) return "color";
  const Value* type = items->find("type");
  if (type == nullptr || !type->isString()) return {};
  if (type->asString() == "number") return "float";
  if (type->asString() == "integer") return "int";
  return type->asString() == "string" ? "string" : "";
}

}  // namespace

namespace {

Value textsAsValue(const std::vector<std::string>& texts) {
  Value list = Value::array();
  for (const std::string& text : texts) list.push(text);
  return list;
}

void addWords(Value& v, std::string_view also) {
  if (!also.empty()) v["also"] = textsAsValue(commaList(also));
}

}  // namespace

Value parametersAsValue(const Configurable& owner) {
  Value list = Value::array();
  for (const Property* property : owner.properties()) {
    const ParamSpec& spec = property->spec();
    Value v = Value::object();
    v["name"] = property->name();
    v["kind"] = property->kind();
    if (property->kind() == "list") {
      if (const std::string elements = elementKind(*property); !elements.empty()) v["elements"] = elements;
    }
    if (!spec.unit.empty()) v["unit"] = spec.unit;
    v["doc"] = spec.doc;
    addWords(v, spec.also);
    v["default"] = property->defaultValue();
    if (std::isfinite(spec.min)) v[spec.aboveMin ? "above" : "min"] = spec.min;
    if (std::isfinite(spec.max)) v["max"] = spec.max;
    if (!std::isnan(spec.softMin)) v["soft_min"] = spec.softMin;
    if (!std::isnan(spec.softMax)) v["soft_max"] = spec.softMax;
    if (const auto condition = property->condition()) {
      v["only_for"]["parameter"] = condition->parameter;
      v["only_for"]["choices"] = textsAsValue(condition->choices);
    }
    v["live"] = spec.live;
    v["animated"] = spec.animated;
    for (const EnumName& choice : property->choices()) {
      Value& choices = v["choices"];
      choices[choice.first] = choice.second;
    }
    if (property->group() != nullptr) v["parameters"] = parametersAsValue(*property->group());
    list.push(std::move(v));
  }
  return list;
}

namespace {

Value portAsValue(const Port& port) {
  Value v = Value::object();
  v["name"] = port.name();
  v["type"] = port.typeName();
  v["doc"] = port.doc();
  return v;
}

}  // namespace

Value typeAsValue(const Registry& registry, const Registry::NodeType& type) {
  const std::unique_ptr<Node> node = registry.createNode(type.info.type);
  Value v = Value::object();
  v["doc"] = type.info.doc;
  addWords(v, type.info.also);
  v["source"] = type.source;
  Value inputs = Value::array(), outputs = Value::array();
  for (const InputPort* input : node->inputs()) {
    Value port = portAsValue(*input);
    port["required"] = input->required();
    port["many"] = input->many();
    inputs.push(std::move(port));
  }
  for (const OutputPort* output : node->outputs()) outputs.push(portAsValue(*output));
  v["inputs"] = std::move(inputs);
  v["outputs"] = std::move(outputs);
  v["parameters"] = parametersAsValue(*node);
  if (const PipelineBase* pipeline = node->pipeline()) {
    v["family"] = pipeline->family();
    Value modules = Value::array();
    for (const auto& module : pipeline->modules()) {
      Value m = Value::object();
      m["name"] = module->name();
      m["type"] = module->info().type;
      m["enabled"] = module->enabled();
      modules.push(std::move(m));
    }
    v["modules"] = std::move(modules);
  }
  return v;
}

Value typeAsValue(const Registry& registry, const Registry::ModuleType& type) {
  const std::unique_ptr<Module> module = registry.createModule(type.info.type);
  Value v = Value::object();
  v["doc"] = type.info.doc;
  addWords(v, type.info.also);
  v["source"] = type.source;
  v["family"] = type.info.family;
  v["parameters"] = parametersAsValue(*module);
  return v;
}

}  // namespace weir
