#include "python/src/python_node.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include "python/src/errors.h"
#include "python/src/given_arrays.h"
#include "python/src/python_scene.h"
#include "python/src/stream_order.h"

namespace weir::python {

PythonNode::PythonNode(PartBase& half, PartTexts texts)
    : PythonPart(*this, half, std::move(texts)), info_{this->texts().type, this->texts().doc} {}

template <class... Arguments>
void PythonNode::callOn(Device& device, const char* method, Arguments&&... arguments) {
  const nb::gil_scoped_acquire gil;
  letStreamWait(device, kLegacyStream);
  struct End {
    Device*& device;
    ~End() { device = nullptr; }
  } const end{device_ = &device};
  call(method, std::forward<Arguments>(arguments)...);
  waitForStream(device, kLegacyStream);
}

void PythonNode::reset(const SetupContext& context) {
  for (const auto& output : outputs_) **output = {};
  callOn(context.device, "reset");
}

void PythonNode::step(const StepContext& context) {
  // What reset() gave is there for the first step, too: whoever takes particles in each step gets them once.
  if (context.index > 0)
    for (const auto& output : outputs_) (*output)->count = 0;
  callOn(context.device, "step", context.dt);
}

void PythonNode::addInput(const std::string& name, const std::string& type, const std::string& doc,
                          bool required, bool many) {
  inputs_.push_back(std::make_unique<PythonInput>(*this, name, type, doc, required, many));
}

void PythonNode::addOutput(const std::string& name, const std::string& doc) {
  outputs_.push_back(std::make_unique<Particles>(*this, name, doc));
}

PythonNode::Particles& PythonNode::outputNamed(const std::string& name) const {
  for (const auto& output : outputs_)
    if (output->name() == name) return *output;
  throw usageError("there is no output '" + name + "'", "an output of the node").inNode(this->name());
}

void PythonNode::put(const std::string& output, nb::dict arrays) {
  Particles& to = outputNamed(output);
  if (device_ == nullptr)
    throw usageError("particles are given to '" + to.path() + "' between steps",
                     "giving them in the node's methods reset and step")
        .inNode(name());
  fillBatch(*to, *device_, std::move(arrays));
}

std::optional<float> PythonNode::spacingOf(const std::string& output) const {
  const auto request = outputNamed(output).requested();
  return request ? std::optional(request->spacing) : std::nullopt;
}

namespace {

PythonNode& nodeOf(const PartBase& half) {
  return dynamic_cast<PythonNode&>(half.part());
}

}  // namespace

void bindNode(nb::module_& m) {
  m.def(
      "add_input",
      [](PartBase& node, const std::string& name, const std::string& type, const std::string& doc,
         bool required, bool many) { nodeOf(node).addInput(name, type, doc, required, many); },
      nb::arg("node"), nb::arg("name"), nb::arg("type"), nb::arg("doc"), nb::arg("required"), nb::arg("many"),
      "Give a node that is written in Python an input.");
  m.def(
      "add_output",
      [](PartBase& node, const std::string& name, const std::string& doc) {
        nodeOf(node).addOutput(name, doc);
      },
      nb::arg("node"), nb::arg("name"), nb::arg("doc"), "Give it an output of particles.");
  m.def(
      "put",
      [](PartBase& node, const std::string& output, nb::dict arrays) { nodeOf(node).put(output, arrays); },
      nb::arg("node"), nb::arg("output"), nb::arg("arrays"), "Give particles out.");
  m.def(
      "spacing_of",
      [](const PartBase& node, const std::string& output) { return nodeOf(node).spacingOf(output); },
      nb::arg("node"), nb::arg("output"), "What the fluids below an output ask for, m.");
  m.def(
      "scene_of",
      [](const PartBase& node) -> std::shared_ptr<PythonScene> {
        PythonScene* const scene = node.part().scene();
        if (scene == nullptr)
          throw usageError("the node is in no scene yet", "scene.add(node, name) before that");
        return scene->shared_from_this();
      },
      nb::arg("node"), "The scene that a node is in.");
}

}  // namespace weir::python
