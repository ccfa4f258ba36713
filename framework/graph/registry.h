// What there is to build scenes from: node types, module types, sections of the scene file, and services
// (readers, observers, …) behind interfaces. Libraries and plugins add to it by an explicit function.
#pragma once

#include <any>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "framework/graph/module.h"
#include "framework/graph/node.h"

namespace weir {

class Registry {
 public:
  struct NodeType {
    NodeInfo info;
    std::string source;  ///< the library that added it
    std::function<std::unique_ptr<Node>()> create;
  };
  struct ModuleType {
    ModuleInfo info;
    std::string source;
    std::function<std::unique_ptr<Module>()> create;
  };
  struct SectionType {
    std::string doc;
    std::string source;
    std::function<std::unique_ptr<Configurable>()> create;
  };

  /// Each throws a scene Error that names both libraries if the name is taken.
  template <class N>
  void addNode() {
    addNodeType({N::kInfo, source_, [] { return std::make_unique<N>(); }});
  }
  template <class M>
  void addModule() {
    addModuleType({M::kInfo, source_, [] { return std::make_unique<M>(); }});
  }
  /// The same for a type that is made at run time, such as a module in another language.
  void addModuleType(ModuleType type);
  /// A section of the scene file beside "world" and "nodes", such as "render".
  template <class S>
  void addSection(const std::string& name, const std::string& doc) {
    addSectionType(name, {doc, source_, [] { return std::make_unique<S>(); }});
  }
  /// A service: an implementation of an interface I, which has `static constexpr std::string_view
  /// kInterface`.
  template <class I>
  void addService(const std::string& name, std::function<std::unique_ptr<I>()> create) {
    addServiceFactory(std::string(I::kInterface), name, std::move(create));
  }

  /// Each throws a scene Error with a suggestion for an unknown type.
  std::unique_ptr<Node> createNode(std::string_view type) const;
  std::unique_ptr<Module> createModule(std::string_view type) const;
  /// One of each service behind I, by name.
  template <class I>
  std::vector<std::pair<std::string, std::unique_ptr<I>>> createServices() const {
    std::vector<std::pair<std::string, std::unique_ptr<I>>> all;
    const auto services = services_.find(std::string(I::kInterface));
    if (services == services_.end()) return all;
    for (const auto& [name, factory] : services->second)
      all.emplace_back(name, std::any_cast<const std::function<std::unique_ptr<I>()>&>(factory)());
    return all;
  }

  const std::map<std::string, NodeType>& nodes() const { return nodes_; }
  const std::map<std::string, ModuleType>& modules() const { return modules_; }
  const std::map<std::string, SectionType>& sections() const { return sections_; }

  /// Who adds from now on; named in errors and listings.
  void setSource(std::string source) { source_ = std::move(source); }
  const std::string& source() const { return source_; }
  /// Keeps a library loaded for as long as this registry, or a copy of it, holds functions of it.
  void keepLoaded(std::shared_ptr<const void> library) { libraries_.push_back(std::move(library)); }

 private:
  void addNodeType(NodeType type);
  void addSectionType(const std::string& name, SectionType type);
  void addServiceFactory(const std::string& interface, const std::string& name, std::any factory);

  std::vector<std::shared_ptr<const void>> libraries_;  // first, so that they outlive all that follows
  std::string source_{kOwnSource};
  std::map<std::string, NodeType> nodes_;
  std::map<std::string, ModuleType> modules_;
  std::map<std::string, SectionType> sections_;
  std::map<std::string, std::map<std::string, std::any>> services_;
};

}  // namespace weir
