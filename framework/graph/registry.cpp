#include "framework/graph/registry.h"

#include "framework/base/text.h"

namespace weir {

namespace {

template <class Entry>
void addUnique(std::map<std::string, Entry>& entries, const std::string& name, Entry entry,
               const char* kind) {
  const auto [place, added] = entries.emplace(name, entry);
  if (!added)
    throw sceneError(std::string("two libraries add the ") + kind + " '" + name +
                         "': " + place->second.source + " and " + entry.source,
                     "a name of its own for each");
}

template <class Entry>
const Entry& lookUp(const std::map<std::string, Entry>& entries, std::string_view name, const char* kind) {
  const auto found = entries.find(std::string(name));
  if (found != entries.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, entry] : entries) names.push_back(known);
  const std::string hint = didYouMean(name, names);
  throw sceneError(std::string("there is no ") + kind + " " + inQuotes(name), joinNames(names),
                   hint.empty() ? "a plugin may be missing" : hint);
}

/// A new object, which knows where it comes from; so does an Error of its constructor.
template <class Entry>
auto created(const Entry& entry, const char* kind) {
  decltype(entry.create()) made;
  callGuarded(
      entry.source,
      [&] { return std::string(kind) + " " + inQuotes(entry.info.type) + " (" + entry.source + ")"; },
      [&] { made = entry.create(); });
  made->setSource(entry.source);
  return made;
}

}  // namespace

void Registry::addNodeType(NodeType type) {
  const std::string name(type.info.type);
  addUnique(nodes_, name, std::move(type), "node type");
}

void Registry::addModuleType(ModuleType type) {
  const std::string name(type.info.type);
  addUnique(modules_, name, std::move(type), "module type");
}

void Registry::addSectionType(const std::string& name, SectionType type) {
  addUnique(sections_, name, std::move(type), "section");
}

void Registry::addServiceFactory(const std::string& interface, const std::string& name, std::any factory) {
  addUnique(services_[interface], name, ServiceType{source_, std::move(factory)}, interface.c_str());
}

std::string Registry::serviceText(const std::string& interface, const std::string& name,
                                  const std::string& source) {
  return hookText(interface + " " + inQuotes(name), "", source);
}

std::unique_ptr<Configurable> Registry::createSection(const std::string& name) const {
  const SectionType& type = lookUp(sections_, name, "section");
  std::unique_ptr<Configurable> made;
  callGuarded(
      type.source, [&] { return hookText("section " + inQuotes(name), "", type.source); },
      [&] { made = type.create(); });
  return made;
}

std::unique_ptr<Node> Registry::createNode(std::string_view type) const {
  return created(lookUp(nodes_, type, "node type"), "node type");
}

std::unique_ptr<Module> Registry::createModule(std::string_view type) const {
  return created(lookUp(modules_, type, "module type"), "module type");
}

}  // namespace weir
