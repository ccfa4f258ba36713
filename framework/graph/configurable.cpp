#include "framework/graph/configurable.h"

#include <algorithm>

#include "framework/base/check.h"
#include "framework/base/text.h"

namespace weir {

Property::Property(Configurable& owner, std::string_view name, const ParamSpec& spec)
    : name_(name), spec_(spec) {
  WEIR_CHECK(owner.findProperty(name) == nullptr);
  owner.properties_.push_back(this);
}

std::optional<Property::Condition> Property::condition() const {
  const std::string_view text = spec_.onlyFor;
  if (text.empty()) return std::nullopt;
  const std::size_t colon = text.find(':');
  WEIR_CHECK(colon != std::string_view::npos);
  return Condition{std::string(text.substr(0, colon)), commaList(text.substr(colon + 1))};
}

Property* Configurable::findProperty(std::string_view name) const {
  for (Property* property : properties_)
    if (property->name() == name) return property;
  return nullptr;
}

namespace {

Error unknownParameter(const Configurable& owner, const std::string& key, const Value& value,
                       const Place& place) {
  std::vector<std::string> names;
  for (const Property* property : owner.properties()) names.push_back(property->name());
  return (place / key)
      .error(value, "there is no parameter " + inQuotes(key),
             names.empty() ? "nothing: there are no parameters" : joinNames(names), didYouMean(key, names));
}

}  // namespace

void Configurable::assignAll(const Value& object, const Place& place) {
  if (!object.isObject())
    throw place.error(object, "found " + object.brief(), "an object of parameters by name");
  std::vector<std::function<void()>> undo;
  try {
    for (const auto& [key, value] : object.asObject()) {
      Property* property = findProperty(key);
      if (property == nullptr) throw unknownParameter(*this, key, value, place);
      undo.push_back(property->undo());
      property->assign(value, place / key);
    }
    validate();
    refuseUnused();
  } catch (Error& e) {
    locate(e);
    for (auto restore = undo.rbegin(); restore != undo.rend(); ++restore) (*restore)();
    throw e.at(place.of(object));
  }
}

void Configurable::refuseUnused() const {
  for (const Property* property : properties_) {
    const auto condition = property->condition();
    if (!condition) continue;
    const Property* chooser = findProperty(condition->parameter);
    WEIR_CHECK(chooser != nullptr);
    if (!property->isSet() || property->value() == property->defaultValue()) continue;
    const std::string chosen = chooser->value().asString();
    const auto& choices = condition->choices;
    if (std::find(choices.begin(), choices.end(), chosen) != choices.end()) continue;
    throw sceneError(
        inQuotes(property->name()) + " is given, which means nothing for the " + chooser->name() + " " +
            inQuotes(chosen),
        "no " + property->name() + ", or as " + chooser->name() + ": " + joinNames(choices, ", "))
        .inParameter(property->name());
  }
}

void Configurable::animate(double time) {
  for (Property* property : properties_) property->animate(time);
}

Error& Configurable::locate(Error& error) const {
  const Property* property = findProperty(error.location().parameter);
  return property != nullptr ? error.at(property->origin()) : error;
}

Value Configurable::changedValues() const {
  Value object = Value::object();
  for (const Property* property : properties_)
    if (!(property->value() == property->defaultValue())) object[property->name()] = property->value();
  return object;
}

Value Configurable::schema() const {
  Value members = Value::object();
  for (const Property* property : properties_) {
    Value schema = property->schema();
    std::string doc(property->spec().doc);
    if (!property->spec().unit.empty())
      doc += (doc.empty() ? "[" : " [") + std::string(property->spec().unit) + "]";
    if (const std::string_view when = property->spec().onlyFor; !when.empty())
      doc += " Only for " + std::string(when) + ".";
    if (!doc.empty()) schema["description"] = doc;
    if (property->group() == nullptr) schema["default"] = property->defaultValue();
    members[property->name()] = std::move(schema);
  }
  Value schema = Value::object();
  schema["type"] = "object";
  schema["properties"] = std::move(members);
  schema["additionalProperties"] = false;
  return schema;
}

template class Param<bool>;
template class Param<int>;
template class Param<std::int64_t>;
template class Param<float>;
template class Param<double>;
template class Param<Vec2f>;
template class Param<Vec3f>;
template class Param<Color>;
template class Param<Rotation>;
template class Param<std::string>;
template class Param<FilePath>;
template class Param<Curve>;
template class Param<std::optional<std::int64_t>>;
template class Param<std::optional<float>>;
template class Param<std::optional<double>>;
template class Param<std::optional<Vec2f>>;
template class Param<std::optional<Vec3f>>;

}  // namespace weir
