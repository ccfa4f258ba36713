#include "framework/scene/moved_modules.h"

#include <algorithm>

#include "framework/base/text.h"
#include "framework/graph/moved_parameters.h"
#include "framework/scene/scene_file.h"

namespace weir {

namespace {

using Parameters = std::vector<MovedParameters::Parameter>;

/// The type that a scene's module has: its own word, or that of the pipeline's default.
std::string typeOf(const std::string& name, const Value& spec, const PipelineBase& pipeline) {
  if (const Value* type = spec.find("type")) return type->isString() ? type->asString() : std::string();
  const Module* module = pipeline.find(name);
  return module != nullptr ? std::string(module->info().type) : std::string();
}

/// Those of `parameters` that are set.
Parameters setAmong(const Parameters& parameters, const Value& params) {
  Parameters set;
  for (const MovedParameters::Parameter& p : parameters)
    if (params.find(p.before) != nullptr) set.push_back(p);
  return set;
}

/// Gives `params` the names of today; what is not set gets the default of before.
void rename(Value& params, const Parameters& parameters, const Module& target, const Value& at) {
  for (const MovedParameters::Parameter& p : parameters) {
    // Whoever gives both names is told by the other type that it knows only one.
    if (params.find(p.now) != nullptr) continue;
    const auto named = [&](const auto& member) { return member.first == p.before; };
    Value::Object& members = params.asObject();
    if (const auto found = std::find_if(members.begin(), members.end(), named); found != members.end()) {
      found->first = p.now;
      continue;
    }
    const Property* property = target.findProperty(p.now);
    if (property != nullptr && property->defaultValue() == p.otherwise) continue;
    Value& added = params[p.now];
    added = p.otherwise;
    added.line = at.line, added.column = at.column, added.origin = at.origin;
  }
}

/// A module that names no type is one of the default type. Where this took the place of another, and the
/// scene sets what only that one has, it means that one.
void nameType(const MovedParameters& moved, const std::string& name, Value& spec,
              const PipelineBase& pipeline) {
  const Value* params = spec.find("params");
  if (spec.find("type") != nullptr || params == nullptr || !params->isObject()) return;
  if (typeOf(name, spec, pipeline) != moved.to() || setAmong(moved.renamed(), *params).empty()) return;
  spec["type"] = Value(moved.from());
}

/// Takes out what changes nothing, if its values are such as the other type takes.
void leaveOut(Value& params, const Parameters& parameters, Module& target, const Place& place) {
  for (const MovedParameters::Parameter& p : parameters) {
    if (Property* property = target.findProperty(p.now))
      property->assign(*params.find(p.before), place / p.before);
    std::erase_if(params.asObject(), [&](const auto& member) { return member.first == p.before; });
  }
}

/// What a scene should say, as a member of "modules".
std::string wordingOf(const std::string& name, const Value& spec) {
  Value all = Value::object();
  Value& module = all[name];
  if (const Value* type = spec.find("type")) module["type"] = *type;
  for (const auto& [key, value] : spec.asObject()) module[key] = value;
  std::string line = writeJsonLine(all);
  while (line.ends_with('\n')) line.pop_back();
  return line;
}

void move(const MovedParameters& moved, const Registry& registry, const std::string& name, Value& spec,
          const Place& place, std::vector<std::string>& warnings) {
  Value* params = spec.find("params");
  if (params == nullptr || !params->isObject()) return;
  const Parameters set = setAmong(moved.parameters(), *params);
  if (set.empty() || !moved.concerns(*params)) return;
  const Value first = *params->find(set.front().before);
  const std::unique_ptr<Module> target = registry.createModule(moved.to());
  std::vector<std::string> names;
  for (const MovedParameters::Parameter& p : set) names.push_back(inQuotes(p.before));
  std::string what =
      "the type " + inQuotes(moved.from()) + " has no parameter " + joinNames(names) + " any more; ";
  std::string hint = "leave it out";
  if (moved.matter(*params)) {
    rename(*params, moved.parameters(), *target, first);
    rename(*params, moved.renamed(), *target, first);
    if (moved.from() == moved.to()) {
      what = moved.meaning();
    } else {
      spec["type"] = Value(moved.to());
      what += "the module is read as one of type " + inQuotes(moved.to());
    }
    hint = "write " + wordingOf(name, spec);
  } else {
    leaveOut(*params, set, *target, place / "params");
    what += "it is ignored, as it has no effect here";
  }
  warnings.emplace_back((place / "params" / set.front().before).error(first, what, {}, hint).what());
}

}  // namespace

Value withMovedParameters(Value modules, const PipelineBase& pipeline, const Registry& registry,
                          const Place& place, std::vector<std::string>& warnings) {
  if (!modules.isObject()) return modules;
  const auto services = registry.createServices<MovedParameters>();
  for (auto& [name, spec] : modules.asObject())
    for (const auto& service : services)
      if (spec.isObject()) {
        const MovedParameters& moved = *service.implementation;
        nameType(moved, name, spec, pipeline);
        if (typeOf(name, spec, pipeline) == moved.from())
          move(moved, registry, name, spec, place / name, warnings);
      }
  return modules;
}

}  // namespace weir
