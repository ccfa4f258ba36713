// A module is one algorithm of a node: a solver, a force, a boundary rule. A node runs a pipeline of named
// modules; a scene may re-parameterise, disable, replace or insert modules by name.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/check.h"
#include "framework/base/log.h"
#include "framework/graph/configurable.h"
#include "framework/graph/guard.h"
#include "framework/graph/state.h"

namespace WEIR_API weir {

class Registry;

/// What a module class says of itself: `static constexpr ModuleInfo kInfo{"Xsph", "FluidModule", "…"};`
struct ModuleInfo {
  std::string_view type;    ///< its name in scenes
  std::string_view family;  ///< the pipelines it fits: the name of its base class
  std::string_view doc;
  std::string_view also = {};  ///< other words for it, parted by commas, by which people look for it
};

/// Between steps it keeps in State members what its node's reset() does not make again; see state.h.
class Module : public Configurable, public Stateful {
 public:
  virtual const ModuleInfo& info() const = 0;

  const std::string& name() const { return name_; }
  void setName(std::string name) { name_ = std::move(name); }
  /// The library that its type comes from, see Registry::setSource.
  const std::string& source() const { return source_; }
  void setSource(std::string source) { source_ = std::move(source); }
  bool enabled() const { return enabled_; }
  void enable(bool on) { enabled_ = on; }

 private:
  std::string name_;
  std::string source_{kOwnSource};
  bool enabled_ = true;
};

/// The ordered modules of one node, seen without their family.
class PipelineBase {
 public:
  explicit PipelineBase(std::string family) : family_(std::move(family)) {}
  PipelineBase(const PipelineBase&) = delete;
  PipelineBase& operator=(const PipelineBase&) = delete;

  const std::string& family() const { return family_; }
  const std::vector<std::unique_ptr<Module>>& modules() const { return modules_; }
  Module* find(std::string_view name) const;
  std::vector<std::string> names() const;

  /// Both throw a scene Error if the module is of another family or the name is taken.
  void insert(std::size_t index, std::unique_ptr<Module> module, std::string name);
  void replace(std::string_view name, std::unique_ptr<Module> module);
  std::size_t indexOf(std::string_view name) const;

  /// Applies a scene's "modules" object: for each name any of
  ///   "type": replaces the module of that name, or makes a new one, which then needs "after" or "before"
  ///           unless it is the first one;
  ///   "after"/"before": the name of the module to stand next to;  "enabled": true or false;
  ///   "params": the module's parameters.
  void assign(const Value& modules, const Registry& registry, const Place& place);
  /// The same, for writing: only what differs from the pipeline as the node's constructor left it.
  Value changedValues() const;
  /// Calls f, which is `hook` of the module; an Error of it says which hook of which module of which plugin
  /// it comes from, if it is a plugin's.
  static void call(const Module& module, std::string_view hook, const std::function<void()>& f);
  /// The state of all modules, also of those that are not enabled.
  void saveState(const StateWriter& to) const;
  void restoreState(const StateReader& from);
  /// To be called by the constructor of a node once its default modules stand.
  void markDefault();

 private:
  /// A module as the node's constructor left it.
  struct Default {
    std::string name, type;
    bool enabled;
    std::vector<Value> values;  // of all its properties
  };

  static Value changedFrom(const Module& module, const Default* initial);
  Module& findOrMake(const std::string& name, const Value& spec, const Registry& registry, const Place& at);
  void checkFamily(const Module& module) const;
  void place(Module& module, const Value& spec, const Place& at);

  std::string family_;
  std::vector<std::unique_ptr<Module>> modules_;
  std::vector<Default> defaults_;
};

/// A pipeline of modules that derive from M, which has `static constexpr std::string_view kFamily`.
template <class M>
class Pipeline final : public PipelineBase {
 public:
  Pipeline() : PipelineBase(std::string(M::kFamily)) {}

  /// Appends a module that the pipeline has by default.
  template <class T>
  T& add(std::string name) {
    auto module = std::make_unique<T>();
    T& reference = *module;
    insert(modules().size(), std::move(module), std::move(name));
    return reference;
  }

  /// Calls f(M&) for every module in order. `hook` is what f calls, for errors.
  template <class F>
  void forEach(std::string_view hook, F&& f) const {
    for (const auto& module : modules()) {
      auto* typed = dynamic_cast<M*>(module.get());
      WEIR_CHECK(typed != nullptr);
      call(*module, hook, [&] { f(*typed); });
    }
  }
  template <class F>
  void forEach(F&& f) const {
    forEach("", std::forward<F>(f));
  }
  /// The same for those that are enabled.
  template <class F>
  void forEachEnabled(std::string_view hook, F&& f) const {
    forEach(hook, [&](M& module) {
      if (module.enabled()) f(module);
    });
  }
  template <class F>
  void forEachEnabled(F&& f) const {
    forEachEnabled("", std::forward<F>(f));
  }
};

}  // namespace weir
