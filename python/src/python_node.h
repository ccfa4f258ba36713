// Nodes that are written in Python.
#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/graph/node.h"
#include "framework/particles/particle_batch.h"
#include "python/src/python_part.h"

namespace weir::python {

namespace nb = nanobind;

/// An input of any type. What arrives there is found by the link's other end.
class PythonInput final : public InputPort {
 public:
  PythonInput(Node& node, const std::string& name, const std::string& type, const std::string& doc,
              bool required, bool many)
      : InputPort(node, name, type, doc, required, many) {}
};

/// The half of a node that a scene holds. It calls the methods `reset`, `step` and `report` of its Python
/// object.
class PythonNode final : public Node, public PythonPart {
 public:
  PythonNode(PartBase& half, PartTexts texts);

  const NodeInfo& info() const override { return info_; }
  void reset(const SetupContext& context) override;
  void step(const StepContext& context) override;
  void report(NodeReport& report) override { addReport(report); }
  void save(const StateWriter& to) const override { saveTo(to); }
  void restore(const StateReader& from) override { restoreFrom(from); }

  /// Before it is in a scene. The output is one of particles on their way into a fluid.
  void addInput(const std::string& name, const std::string& type, const std::string& doc, bool required,
                bool many);
  void addOutput(const std::string& name, const std::string& doc);
  /// Gives these particles out in the present reset or step. Throws a usage Error outside of these.
  void put(const std::string& output, nb::dict arrays);
  /// The spacing in m that the fluids below ask for; nothing if there are none.
  std::optional<float> spacingOf(const std::string& output) const;

  void attachTo(PythonScene& scene) { attach(scene); }
  const std::string& name() const override { return Node::name(); }
  Target target() const override { return {Target::Kind::kNode, name(), ""}; }

 private:
  using Particles = Output<ParticleBatch>;

  /// With the device at hand for put(), and other libraries' work on it in order.
  template <class... Arguments>
  void callOn(Device& device, const char* method, Arguments&&... arguments);
  Particles& outputNamed(const std::string& name) const;

  NodeInfo info_;
  std::vector<std::unique_ptr<PythonInput>> inputs_;
  std::vector<std::unique_ptr<Particles>> outputs_;
  Device* device_ = nullptr;  // within reset and step
};

void bindNode(nb::module_& m);

}  // namespace weir::python
