#include "framework/graph/module.h"

#include <algorithm>

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
  const std::string nearest = closestName(name, names());
  throw sceneError("there is no module '" + std::string(name) + "'", joinNames(names()),
                   nearest.empty() ? "" : "did you mean '" + nearest + "'?");
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
    throw sceneError("there are two modules '" + name + "'", "a name of its own for each");
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

void PipelineBase::markDefault() {
  defaults_.clear();
  for (const auto& module : modules_)
    defaults_.emplace_back(module->name(), std::string(module->info().type));
}

namespace {

constexpr const char* kModuleKeys[] = {"type", "params", "enabled", "after", "before"};

void checkModuleKeys(const Value& spec, const Place& place) {
  if (!spec.isObject()) throw place.error(spec, "found " + spec.brief(), "an object that describes a module");
  const std::vector<std::string> known(std::begin(kModuleKeys), std::end(kModuleKeys));
  for (const auto& [key, value] : spec.asObject()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::string nearest = closestName(key, known);
    throw(place / key)
        .error(value, "a module has no '" + key + "'", joinNames(known),
               nearest.empty() ? "" : "did you mean '" + nearest + "'?");
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

void PipelineBase::assign(const Value& modules, const Registry& registry, const Place& at) {
  if (!modules.isObject())
    throw at.error(modules, "found " + modules.brief(), "an object of modules by name");
  for (const auto& [name, spec] : modules.asObject()) {
    const Place here = at / name;
    checkModuleKeys(spec, here);
    try {
      Module* module = find(name);
      const std::string* type = readText(spec, "type", here);
      if (module == nullptr) {
        if (type == nullptr) indexOf(name);  // throws with a suggestion
        if (spec.find("after") == nullptr && spec.find("before") == nullptr)
          throw sceneError("the new module '" + name + "' has no place",
                           "\"after\" or \"before\" with the name of " + joinNames(names()));
        insert(modules_.size(), registry.createModule(*type), name);
      } else if (type != nullptr && *type != module->info().type) {
        replace(name, registry.createModule(*type));
      }
    } catch (Error& e) {
      throw e.at(here.of(spec));
    }
    Module& module = *find(name);
    place(module, spec, here);
    if (const Value* enabled = spec.find("enabled"))
      module.enable(ParamTraits<bool>::fromValue(*enabled, {}, here / "enabled"));
    if (const Value* params = spec.find("params")) module.assignAll(*params, here / "params");
  }
}

Value PipelineBase::changedValues() const {
  Value all = Value::object();
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    const Module& module = *modules_[i];
    Value spec = Value::object();
    const auto isDefault = [&](const auto& d) { return d.first == module.name(); };
    const auto found = std::find_if(defaults_.begin(), defaults_.end(), isDefault);
    if (found == defaults_.end() || found->second != module.info().type) spec["type"] = module.info().type;
    if (found == defaults_.end()) {
      // The module before it stands already when this one is read, if it is written in this order.
      if (i > 0)
        spec["after"] = modules_[i - 1]->name();
      else if (modules_.size() > 1)
        spec["before"] = modules_[1]->name();
    }
    if (!module.enabled()) spec["enabled"] = false;
    if (Value params = module.changedValues(); !params.asObject().empty()) spec["params"] = std::move(params);
    if (!spec.asObject().empty()) all[module.name()] = std::move(spec);
  }
  return all;
}

}  // namespace weir
