#include "python/src/library.h"

#include <dlfcn.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>

#include "framework/base/build_info.h"
#include "framework/compute/device.h"
#include "framework/graph/plugin_probe.h"
#include "framework/graph/type_values.h"
#include "framework/run/guarded_output.h"
#include "framework/scene/scene_file.h"
#include "framework/solids/solid.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/register_nodes.h"
#include "python/src/errors.h"
#include "python/src/python_part.h"
#include "python/src/values.h"

namespace weir::python {

namespace fs = std::filesystem;

Library::Library() {
  auto registry = std::make_shared<Registry>();
  registerNodes(*registry);
  registry_ = std::move(registry);
}

void Library::loadPlugin(const std::string& file) {
  std::error_code error;
  for (const Plugin& plugin : plugins_)
    if (fs::equivalent(plugin.file(), file, error)) return;
  probePlugin(file);
  auto registry = std::make_shared<Registry>(*registry_);
  Plugin plugin(file, *registry);
  plugins_.push_back(std::move(plugin));
  registry_ = std::move(registry);
}

std::vector<std::string> Library::plugins() const {
  std::vector<std::string> files;
  for (const Plugin& plugin : plugins_) files.push_back(plugin.file().string());
  return files;
}

namespace {

/// What the registry's function that makes objects of a class holds: the texts live as long as it.
struct PythonType {
  explicit PythonType(nb::object type)
      : texts{nb::cast<std::string>(type.attr("__name__")), docOf(type)}, held(std::move(type)) {}

  PartTexts texts;
  HeldObject held;
};

}  // namespace

void Library::registerModule(nb::object type) {
  auto registry = std::make_shared<Registry>(*registry_);
  const auto made = std::make_shared<const PythonType>(std::move(type));
  registry->addModuleType({{made->texts.type, FluidModule::kFamily, made->texts.doc},
                           registry->source(),
                           [made] { return makePythonPart<Module>(made->held.object); }});
  registry_ = std::move(registry);
}

void Library::registerNode(nb::object type) {
  auto registry = std::make_shared<Registry>(*registry_);
  const auto made = std::make_shared<const PythonType>(std::move(type));
  registry->addNodeType({{made->texts.type, made->texts.doc}, registry->source(), [made] {
                           return makePythonPart<Node>(made->held.object);
                         }});
  registry_ = std::move(registry);
}

std::string ownPluginFolder() {
  Dl_info self{};
  if (dladdr(reinterpret_cast<const void*>(&version), &self) == 0) return {};
  std::error_code error;
  return (fs::canonical(self.dli_fname, error).parent_path() / "weir/plugins").string();
}

namespace {

nb::object describeTypes(const Library& library) {
  const Registry& registry = *library.registry();
  Value nodes = Value::object(), modules = Value::object(), sections = Value::object();
  for (const auto& [name, type] : registry.nodes()) {
    nodes[name] = typeAsValue(registry, type);
    nodes[name]["moves"] = dynamic_cast<const RigidMotion*>(registry.createNode(name).get()) != nullptr;
  }
  for (const auto& [name, type] : registry.modules()) modules[name] = typeAsValue(registry, type);
  sections["world"]["doc"] = "What all nodes of a scene share.";
  sections["world"]["parameters"] = parametersAsValue(World());
  for (const auto& [name, type] : registry.sections()) {
    sections[name]["doc"] = type.doc;
    sections[name]["parameters"] = parametersAsValue(*type.create());
  }
  Value all = Value::object();
  all["nodes"] = std::move(nodes);
  all["modules"] = std::move(modules);
  all["sections"] = std::move(sections);
  return toPython(all, false);
}

nb::object describeOutputs(const Library& library) {
  Value all = Value::object();
  for (const auto& [service, kind, source] : library.registry()->createServices<OutputKind>())
    for (const OutputOption& option : optionsOf(*kind, service, source)) {
      Value& v = all[option.name];
      v["argument"] = option.argument;
      v["doc"] = option.doc;
    }
  return toPython(all, false);
}

}  // namespace

void bindLibrary(nb::module_& m) {
  nb::class_<Library>(m, "Library", "Node, module and output types that scenes are built from.")
      .def(nb::init<>())
      .def("load_plugin", &Library::loadPlugin, nb::arg("file"), "Load a plugin's shared library.")
      .def_prop_ro("plugins", &Library::plugins, "Files of the plugins that are loaded.")
      .def("register_module", &Library::registerModule, nb::arg("type"),
           "Make a class of modules known by its name.")
      .def("register_node", &Library::registerNode, nb::arg("type"),
           "Make a class of nodes known by its name.")
      .def("types", &describeTypes, nb::sig("def types(self) -> dict"),
           "All types with their parameters and ports, as data.")
      .def("outputs", &describeOutputs, nb::sig("def outputs(self) -> dict"),
           "What a run can write, by the names of the options.")
      .def(
          "schema", [](const Library& library) { return writeJson(sceneSchema(*library.registry())); },
          "JSON Schema of scene files.");
  m.def("own_plugin_folder", &ownPluginFolder, "The folder of the plugins that come with Weir.");
  m.def(
      "version", [] { return std::string(version()); }, "Weir's version.");
  m.def("built_with_cuda", &builtWithCuda, "Whether this build can run on CUDA.");
  m.def(
      "devices",
      [] {
        nb::list devices;
        for (const DeviceInfo& device : listDevices())
          devices.append(nb::make_tuple(device.name, device.description));
        return devices;
      },
      nb::sig("def devices() -> list[tuple[str, str]]"), "Names and descriptions of this machine's devices.");
}

}  // namespace weir::python
