#include "framework/graph/module.h"

#include <algorithm>

#include "framework/base/text.h"
#include "framework/graph/registry.h"

namespace weir {

Module* PipelineBase::find(std::string_view name) const {
  for (const auto& module : modules_)
    if (module->name() == name) return module.get();
  return nullptr;
}

std::vector<std::string> PipelineBase::names() const {
  std::vector<std::string> names;
  for (const auto& module : modules_) names.push_back(module->name());
  return names;
}

std::size_t PipelineBase::indexOf(std::string_view name) const {
  for (std::size_t i = 0; i < modules_.size(); ++i)
    if (modules_[i]->name() == name) return i;
  throw sceneError("there is no module " + inQuotes(name),
                   modules_.empty() ? "nothing: there are no modules" : joinNames(names()),
                   didYouMean(name, names()));
}

void PipelineBase::checkFamily(const Module& module) const {
  if (module.info().family != family_)
    throw sceneError("a " + std::string(module.info().type) + " is a " + std::string(module.info().family) +
                         " and does not fit here",
                     "a module of the family " + family_);
}

void PipelineBase::insert(std::size_t index, std::unique_ptr<Module> module, std::string name) {
  checkFamily(*module);
  if (find(name) != nullptr)
    throw sceneError("there are two modules " + inQuotes(name), "a name of its own for each");
  WEIR_CHECK(index <= modules_.size());
  module->setName(std::move(name));
  modules_.insert(modules_.begin() + static_cast<std::ptrdiff_t>(index), std::move(module));
}

void PipelineBase::replace(std::string_view name, std::unique_ptr<Module> module) {
  checkFamily(*module);
  auto& place = modules_[indexOf(name)];
  module->setName(std::string(name));
  place = std::move(module);
}

void PipelineBase::call(const Module& module, std::string_view hook, const std::function<void()>& f) {
  callGuarded(
      module.source(), [&] { return hookText("module " + inQuotes(module.name()), hook, module.source()); },
      f);
}

void PipelineBase::saveState(const StateWriter& to) const {
  for (const auto& module : modules_)
    call(*module, "save", [&] { module->saveState(to.in(module->name())); });
}

void PipelineBase::restoreState(const StateReader& from) {
  for (const auto& module : modules_)
    call(*module, "restore", [&] { module->restoreState(from.in(module->name())); });
}

void PipelineBase::markDefault() {
  defaults_.clear();
  for (const auto& module : modules_) {
    Default initial{module->name(), std::string(module->info().type), module->enabled(), {}};
    for (const Property* property : module->properties()) initial.values.push_back(property->value());
    defaults_.push_back(std::move(initial));
  }
}

namespace {

constexpr const char* kModuleKeys[] = {"type", "params", "enabled", "after", "before"};

void checkModuleKeys(const Value& spec, const Place& place) {
  if (!spec.isObject()) throw place.error(spec, "found " + spec.brief(), "an object that describes a module");
  const std::vector<std::string> known(std::begin(kModuleKeys), std::end(kModuleKeys));
  for (const auto& [key, value] : spec.asObject()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    throw(place / key)
        .error(value, "a module has no member " + inQuotes(key), joinNames(known), didYouMean(key, known));
  }
}

const std::string* readText(const Value& spec, const char* key, const Place& place) {
  const Value* value = spec.find(key);
  if (value == nullptr) return nullptr;
  if (!value->isString()) throw(place / key).error(*value, "found " + value->brief(), "a name");
  return &value->asString();
}

}  // namespace

void PipelineBase::place(Module& module, const Value& spec, const Place& at) {
  const std::string* after = readText(spec, "after", at);
  const std::string* before = readText(spec, "before", at);
  if (after == nullptr && before == nullptr) return;
  if (after != nullptr && before != nullptr)
    throw at.error(spec, "the module has both \"after\" and \"before\"", "one of them");
  const std::string& neighbor = after != nullptr ? *after : *before;
  if (neighbor == module.name())
    throw at.error(spec, "the module is placed next to itself", "another module's name");
  try {
    const std::size_t from = indexOf(module.name());
    indexOf(neighbor);  // checked before anything moves
    std::unique_ptr<Module> moving = std::move(modules_[from]);
    modules_.erase(modules_.begin() + static_cast<std::ptrdiff_t>(from));
    const std::size_t to = indexOf(neighbor) + (after != nullptr ? 1 : 0);
    modules_.insert(modules_.begin() + static_cast<std::ptrdiff_t>(to), std::move(moving));
  } catch (Error& e) {
    throw e.at(at.of(spec));
  }
}

Module& PipelineBase::findOrMake(const std::string& name, const Value& spec, const Registry& registry,
                                 const Place& at) {
  const std::string* type = readText(spec, "type", at);
  Module* module = find(name);
  if (module != nullptr && (type == nullptr || *type == module->info().type)) return *module;
  if (type == nullptr) indexOf(name);  // throws with a suggestion
  try {
    std::unique_ptr<Module> made = registry.createModule(*type);
    checkFamily(*made);
    if (module != nullptr) {
      replace(name, std::move(made));
      return *find(name);
    }
    if (!isName(name))
      throw sceneError(inQuotes(name) + " is not a valid name for a module",
                       "letters, digits, '_' and '-', starting with a letter");
    if (!modules_.empty() && spec.find("after") == nullptr && spec.find("before") == nullptr)
      throw sceneError("the new module " + inQuotes(name) + " has no place",
                       "\"after\" or \"before\" with the name of " + joinNames(names()));
    insert(modules_.size(), std::move(made), name);
    return *find(name);
  } catch (Error& e) {
    throw e.at((at / "type").of(*spec.find("type")));
  }
}

void PipelineBase::assign(const Value& modules, const Registry& registry, const Place& at) {
  constexpr std::size_t kMaxModules = 1000;
  if (!modules.isObject() || modules.asObject().size() > kMaxModules)
    throw at.error(modules, "found " + modules.brief(),
                   "an object of at most " + std::to_string(kMaxModules) + " modules by name");
  for (const auto& [name, spec] : modules.asObject()) {
    const Place here = at / name;
    checkModuleKeys(spec, here);
    try {
      Module& module = findOrMake(name, spec, registry, here);
      place(module, spec, here);
      if (const Value* enabled = spec.find("enabled"))
        module.enable(ParamTraits<bool>::fromValue(*enabled, {}, here / "enabled"));
      const Value* params = spec.find("params");
      const auto where = [&] { return hookText("module " + inQuotes(name), "validate", module.source()); };
      const auto set = [&] { module.assignAll(*params, here / "params"); };
      if (params != nullptr) callGuarded(module.source(), where, set, /*filesSayEnough=*/true);
    } catch (Error& e) {
      throw e.at(here.of(spec));
    }
  }
}

Value PipelineBase::changedFrom(const Module& module, const Default* initial) {
  Value spec = Value::object();
  const bool sameType = initial != nullptr && initial->type == module.info().type;
  if (!sameType) spec["type"] = module.info().type;
  if (module.enabled() != (sameType ? initial->enabled : true)) spec["enabled"] = module.enabled();
  Value params = sameType ? Value::object() : module.changedValues();
  if (sameType)
    for (std::size_t i = 0; i < initial->values.size(); ++i)
      if (const Property& property = *module.properties()[i]; !(property.value() == initial->values[i]))
        params[property.name()] = property.value();
  if (!params.asObject().empty()) spec["params"] = std::move(params);
  return spec;
}

Value PipelineBase::changedValues() const {
  // `order` follows how assign() will move and insert modules when it reads what is written here.
  std::vector<std::string> order;
  for (const Default& d : defaults_) order.push_back(d.name);
  Value all = Value::object();
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    const Module& module = *modules_[i];
    const auto isDefault = [&](const Default& d) { return d.name == module.name(); };
    const auto initial = std::find_if(defaults_.begin(), defaults_.end(), isDefault);
    Value spec = changedFrom(module, initial == defaults_.end() ? nullptr : &*initial);
    if (i >= order.size() || order[i] != module.name()) {
      if (i > 0)
        spec["after"] = modules_[i - 1]->name();
      else if (!order.empty())
        spec["before"] = order.front();
      std::erase(order, module.name());
      order.insert(order.begin() + static_cast<std::ptrdiff_t>(i), module.name());
    }
    if (!spec.asObject().empty()) all[module.name()] = std::move(spec);
  }
  return all;
}

}  // namespace weir
