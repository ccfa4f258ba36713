// Modules of a fluid that are written in Python.
#pragma once

#include <nanobind/nanobind.h>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "nodes/particle_fluid/fluid_module.h"

namespace weir::python {

namespace nb = nanobind;

class ModuleBase;
class PythonScene;

/// What the infos of types refer to.
struct ModuleTexts {
  std::string type, doc;
};

/// The docstring of a class without its indentation; "" if it has none.
std::string docOf(nb::handle type);

/// What is said of a parameter where it is declared, see weir.Param.
struct PythonParameter {
  std::string name, unit, doc;
  double min, max;
  bool aboveMin, live, animated;
};

/// The half of the module that a pipeline holds. It calls the methods `reset` and `step` of its Python
/// object. What they raise leaves the step as it is, with its traceback.
class PythonModule final : public FluidModule {
 public:
  PythonModule(ModuleBase& half, ModuleTexts texts);
  ~PythonModule() override;

  const ModuleInfo& info() const override { return info_; }
  void reset(FluidStep& fluid) override;
  void step(FluidStep& fluid) override;
  void report(NodeReport& report) override;
  /// What the class names in `state`, and what its method save() returns; see weir.Module.
  void save(const StateWriter& to) const override;
  void restore(const StateReader& from) override;

  /// The kind of the parameter is that of its first value: bool, int, float, str, or a sequence of two or
  /// three numbers. Throws Python's TypeError for others.
  void define(const PythonParameter& parameter, nb::handle initial);
  /// The value at the present time.
  nb::object get(const std::string& name) const;

  /// Holds the Python object from now on, as a pipeline holds this.
  void keep(nb::object self) { self_ = std::move(self); }
  nb::object self() const { return self_; }
  void attach(PythonScene& scene, std::string node);
  PythonScene* scene() const { return scene_; }
  const std::string& node() const { return node_; }

 private:
  template <class T>
  void addParam(const std::string& name, nb::handle initial, ParamSpec spec);
  /// Whether neighbours are searched before it in each step.
  bool comesAfterSearch() const;
  void call(const char* method, FluidStep& fluid, bool withDt);

  ModuleBase& half_;
  ModuleTexts texts_;
  ModuleInfo info_;
  std::deque<std::string> strings_;  // that parameters refer to
  std::vector<std::unique_ptr<Property>> parameters_;
  std::map<std::string, std::function<Value()>> getters_;
  nb::object self_;
  PythonScene* scene_ = nullptr;  // outlives this
  std::string node_;
};

/// The half that Python sees: the base of weir.Module. It owns the other half until a pipeline does.
class ModuleBase {
 public:
  /// Throws a usage Error if there is none: before `begin`, and when the pipeline that held it is gone.
  PythonModule& module() const;
  void begin(ModuleTexts texts);
  /// Gives it to a pipeline. Throws a usage Error if it is in one already.
  std::unique_ptr<Module> give(nb::object self);

 private:
  friend class PythonModule;
  std::unique_ptr<PythonModule> own_;
  PythonModule* module_ = nullptr;
};

/// Calls the class, and gives what it makes to a pipeline.
std::unique_ptr<Module> makePythonModule(nb::handle type);

void bindModule(nb::module_& m);

}  // namespace weir::python
