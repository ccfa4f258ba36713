// Modules of a fluid that are written in Python.
#pragma once

#include <nanobind/nanobind.h>

#include <string>

#include "nodes/particle_fluid/fluid_module.h"
#include "python/src/python_part.h"

namespace weir::python {

namespace nb = nanobind;

/// The half of a module that a pipeline holds. It calls the methods `reset` and `step` of its Python object.
class PythonModule final : public FluidModule, public PythonPart {
 public:
  PythonModule(PartBase& half, PartTexts texts);

  const ModuleInfo& info() const override { return info_; }
  void reset(FluidStep& fluid) override;
  void step(FluidStep& fluid) override;
  void report(NodeReport& report) override { addReport(report); }
  void save(const StateWriter& to) const override { saveTo(to); }
  void restore(const StateReader& from) override { restoreFrom(from); }

  void attachTo(PythonScene& scene, std::string node);
  const std::string& node() const { return node_; }
  const std::string& name() const override { return Module::name(); }
  Target target() const override { return {Target::Kind::kModule, node_, name()}; }

 private:
  /// Whether neighbours are searched before it in each step.
  bool comesAfterSearch() const;
  void callIn(const char* method, FluidStep& fluid, bool withDt);

  ModuleInfo info_;
  std::string node_;
};

void bindModule(nb::module_& m);

}  // namespace weir::python
