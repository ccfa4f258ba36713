// What Python sees of scenes.
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>

#include "framework/scene/scene_file.h"
#include "python/src/given_arrays.h"
#include "python/src/node_outputs.h"
#include "python/src/particles.h"
#include "python/src/python_part.h"
#include "python/src/python_scene.h"
#include "python/src/values.h"
#include "python/src/walls.h"

namespace weir::python {

namespace {

/// A scene with nothing but the sections that there are.
std::unique_ptr<Scene> emptyScene(const Registry& registry) {
  auto scene = std::make_unique<Scene>();
  for (const auto& [name, type] : registry.sections()) {
    scene->sections[name] = type.create();
    scene->sections[name]->assignAll(Value::object(), {});
  }
  return scene;
}

/// `file` and `folder` may be empty: then it comes from nowhere.
std::shared_ptr<PythonScene> parse(const std::shared_ptr<Library>& library, const std::string& text,
                                   const std::string& file, const std::string& folder,
                                   const std::vector<std::string>& changes) {
  const Value root = parseScene(text, file);
  const Place place{file, "", folder};
  for (const FilePath& plugin : scenePlugins(withIncludes(root, place), place))
    library->loadPlugin(plugin.resolved.string());
  std::vector<Override> overrides;
  for (const std::string& change : changes) overrides.push_back(parseOverride(change));
  std::vector<std::string> warnings;
  std::unique_ptr<Scene> built = buildScene(root, place, *library->registry(), overrides, warnings);
  built->text = textToKeep(text, root, *built);
  auto scene = std::make_shared<PythonScene>(library, std::move(built), folder);
  for (const std::string& warning : warnings) scene->log().warn(warning);
  return scene;
}

std::shared_ptr<PythonScene> load(const std::shared_ptr<Library>& library, const std::string& file,
                                  const std::vector<std::string>& changes) {
  const std::filesystem::path path(file);
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  return parse(library, readTextFile(path, kLargestSceneFile), file, folder.string(), changes);
}

nb::list nodesOf(const PythonScene& scene) {
  nb::list nodes;
  for (const auto& node : scene.scene().graph.nodes())
    nodes.append(nb::make_tuple(node->name(), std::string(node->info().type)));
  return nodes;
}

std::vector<std::string> linksOf(const PythonScene& scene) {
  std::vector<std::string> links;
  for (const Link& link : scene.scene().graph.links()) links.push_back(link.text());
  return links;
}

std::vector<std::string> sectionsOf(const PythonScene& scene) {
  std::vector<std::string> names;
  for (const auto& [name, section] : scene.scene().sections) names.push_back(name);
  return names;
}

nb::list modulesOf(const PythonScene& scene, const std::string& node) {
  nb::list modules;
  if (scene.node(node).pipeline() == nullptr) return modules;
  for (const auto& module : scene.pipeline(node).modules())
    modules.append(nb::make_tuple(module->name(), std::string(module->info().type)));
  return modules;
}

/// The object of a module or node that is written in Python, or None.
template <class T>
nb::object objectOf(const T& part) {
  const auto* python = dynamic_cast<const PythonPart*>(&part);
  return python != nullptr ? python->self() : nb::none();
}

/// `type` is the name of a type, or an object of a class of nodes; `arrays` are what giveArrays takes, or
/// None.
void addNode(PythonScene& scene, nb::object type, const std::string& name, nb::handle parameters,
             nb::object arrays) {
  std::unique_ptr<Node> node = nb::isinstance<nb::str>(type)
                                   ? scene.registry()->createNode(nb::cast<std::string>(type))
                                   : nb::cast<PartBase&>(type).give<Node>(type);
  if (!arrays.is_none()) giveArrays(*node, nb::cast<nb::dict>(arrays));
  scene.addNode(std::move(node), name, toValue(parameters));
}

/// `module` is the name of a type, or an object of a class of modules.
void insertModule(PythonScene& scene, const std::string& node, nb::object module, const std::string& name,
                  std::optional<std::size_t> index, nb::handle parameters) {
  std::unique_ptr<Module> made;
  Value params = toValue(parameters);
  if (nb::isinstance<nb::str>(module)) {
    auto type = nb::cast<std::string>(module);
    if (params.isObject()) scene.readMoved(node, name, type, params);
    made = scene.registry()->createModule(type);
  } else {
    made = nb::cast<PartBase&>(module).give<Module>(module);
  }
  try {
    made->assignAll(params, {});
  } catch (Error& e) {
    throw e.inNode(node);
  }
  scene.insertModule(node, std::move(made), name, index);
}

Target targetOf(const std::string& kind, const std::string& name, const std::string& module) {
  if (kind == "world") return {Target::Kind::kWorld, "", ""};
  if (kind == "section") return {Target::Kind::kSection, name, ""};
  if (kind == "node") return {Target::Kind::kNode, name, ""};
  return {Target::Kind::kModule, name, module};
}

}  // namespace

void bindScene(nb::module_& m) {
  using S = PythonScene;
  nb::class_<Target>(m, "Target",
                     "Whose parameters are meant: those of the world, a section, a node or a module.")
      .def(
          "__init__",
          [](Target* t, const std::string& kind, const std::string& name, const std::string& module) {
            new (t) Target(targetOf(kind, name, module));
          },
          nb::arg("kind"), nb::arg("name") = "", nb::arg("module") = "");
  nb::class_<S>(m, "Scene", "What weir.Scene is made of.")
      .def(nb::new_([](std::shared_ptr<Library> library) {
             return std::make_shared<S>(library, emptyScene(*library->registry()), "");
           }),
           nb::arg("library"))
      .def_static("load", &load, nb::arg("library"), nb::arg("file"), nb::arg("changes"))
      .def_static("parse", &parse, nb::arg("library"), nb::arg("text"), nb::arg("file"), nb::arg("folder"),
                  nb::arg("changes"))
      .def("add_node", &addNode, nb::arg("type"), nb::arg("name"), nb::arg("parameters"),
           nb::arg("arrays") = nb::none())
      .def("give", &S::give, nb::arg("node"), nb::arg("arrays"))
      .def(
          "given", [](const S& s, const std::string& node) { return givenArrays(s.node(node)); },
          nb::arg("node"), nb::sig("def given(self, node: str) -> dict | None"))
      .def("nodes_with_arrays", [](const S& s) { return nodesWithArrays(s.scene()); })
      .def("output", &outputOf, nb::arg("node"), nb::arg("output"))
      .def("walls", &wallsOf, nb::arg("node"), nb::arg("output"))
      .def("report", &reportOf, nb::arg("node"), nb::sig("def report(self, node: str) -> dict"))
      .def("pose", &poseOf, nb::arg("node"), nb::arg("time").none(),
           nb::sig("def pose(self, node: str, time: float | None) -> tuple"))
      .def("motion", &motionOf, nb::arg("node"), nb::sig("def motion(self, node: str) -> tuple"))
      .def("place", &placeBody, nb::arg("node"), nb::arg("rotation"), nb::arg("translation"),
           nb::arg("velocity"), nb::arg("angular_velocity"))
      .def("sampled", &sampled, nb::arg("node"), nb::arg("attribute"), nb::arg("points"),
           nb::sig("def sampled(self, node: str, attribute: str, points: numpy.ndarray) -> numpy.ndarray"))
      .def("link", &S::link, nb::arg("text"))
      .def("nodes", &nodesOf, nb::sig("def nodes(self) -> list[tuple[str, str]]"))
      .def("links", &linksOf)
      .def("sections", &sectionsOf)
      .def("modules", &modulesOf, nb::arg("node"),
           nb::sig("def modules(self, node: str) -> list[tuple[str, str]]"))
      .def(
          "module_object",
          [](const S& s, const std::string& node, const std::string& name) {
            return objectOf(s.module(node, name));
          },
          nb::arg("node"), nb::arg("name"),
          nb::sig("def module_object(self, node: str, name: str) -> PartBase | None"))
      .def(
          "node_object", [](const S& s, const std::string& node) { return objectOf(s.node(node)); },
          nb::arg("node"), nb::sig("def node_object(self, node: str) -> PartBase | None"))
      .def("time", [](const S& s) { return s.simulation() != nullptr ? s.simulation()->time() : 0; })
      .def(
          "module_enabled",
          [](const S& s, const std::string& node, const std::string& name) {
            return s.module(node, name).enabled();
          },
          nb::arg("node"), nb::arg("name"))
      .def(
          "enable_module",
          [](const S& s, const std::string& node, const std::string& name, bool on) {
            s.module(node, name).enable(on);
          },
          nb::arg("node"), nb::arg("name"), nb::arg("on"))
      .def("insert_module", &insertModule, nb::arg("node"), nb::arg("module"), nb::arg("name"),
           nb::arg("index").none(), nb::arg("parameters"))
      .def(
          "get",
          [](const S& s, const Target& target, const std::vector<std::string>& path) {
            return toPython(s.get(target, path), true);
          },
          nb::arg("target"), nb::arg("path"),
          nb::sig("def get(self, target: Target, path: list[str]) -> typing.Any"))
      .def(
          "assign", [](S& s, const Target& target, nb::handle values) { s.assign(target, toValue(values)); },
          nb::arg("target"), nb::arg("values"))
      .def("to_json", &S::toJson, nb::arg("folder"), nb::arg("files") = std::map<std::string, std::string>())
      .def("validate", [](const S& s) { s.scene().graph.validate(); })
      .def(
          "particles",
          [](std::shared_ptr<S> s, const std::string& node) { return Particles(std::move(s), node); },
          nb::arg("node"))
      .def_prop_rw(
          "title", [](const S& s) { return s.scene().title; },
          [](const S& s, std::string title) { s.scene().title = std::move(title); });
}

}  // namespace weir::python
