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

#include "framework/base/api.h"
#include "framework/graph/guard.h"
#include "framework/graph/module.h"
#include "framework/graph/node.h"

namespace WEIR_API weir {

/// An implementation of an interface, under its name, and the library that it comes from.
template <class I>
struct Service {
  std::string name;
  std::unique_ptr<I> implementation;
  std::string source;
};

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
  /// The same for types that are made at run time, such as those in another language.
  void addModuleType(ModuleType type);
  void addNodeType(NodeType type);
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
  std::unique_ptr<Configurable> createSection(const std::string& name) const;
  /// One of each service behind I, by name. Whoever calls them guards what comes from a plugin (guard.h).
  template <class I>
  std::vector<Service<I>> createServices() const {
    std::vector<Service<I>> all;
    const auto services = services_.find(std::string(I::kInterface));
    if (services == services_.end()) return all;
    for (const auto& [name, type] : services->second) {
      const auto& factory = std::any_cast<const std::function<std::unique_ptr<I>()>&>(type.factory);
      std::unique_ptr<I> made;
      callGuarded(
          type.source, [&] { return serviceText(services->first, name, type.source); },
          [&] { made = factory(); });
      all.push_back({name, std::move(made), type.source});
    }
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
  void addSectionType(const std::string& name, SectionType type);
  void addServiceFactory(const std::string& interface, const std::string& name, std::any factory);
  static std::string serviceText(const std::string& interface, const std::string& name,
                                 const std::string& source);

  struct ServiceType {
    std::string source;
    std::any factory;
  };

  std::vector<std::shared_ptr<const void>> libraries_;  // first, so that they outlive all that follows
  std::string source_{kOwnSource};
  std::map<std::string, NodeType> nodes_;
  std::map<std::string, ModuleType> modules_;
  std::map<std::string, SectionType> sections_;
  std::map<std::string, std::map<std::string, ServiceType>> services_;
};

}  // namespace weir
