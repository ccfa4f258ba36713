#include "python/src/python_scene.h"

#include <filesystem>

#include "framework/base/text.h"
#include "framework/particles/particles.h"
#include "framework/scene/moved_modules.h"
#include "framework/scene/scene_file.h"
#include "nodes/particle_file/particle_file.h"
#include "python/src/errors.h"
#include "python/src/given_arrays.h"
#include "python/src/python_module.h"
#include "python/src/python_node.h"

namespace weir::python {

namespace fs = std::filesystem;

namespace {

/// Messages go to the logger "weir". They may come from any thread; a handler that fails is reported by
/// Python and stops nothing.
void logToPython(LogLevel level, std::string_view message) {
  constexpr int kLevels[] = {10, 20, 30, 40};  // of Python's logging
  const nb::gil_scoped_acquire gil;
  const nb::error_scope present;
  try {
    nb::module_::import_("logging").attr("getLogger")("weir").attr("log")(
        kLevels[static_cast<int>(level)], "%s", nb::str(message.data(), message.size()));
  } catch (nb::python_error& error) {
    error.discard_as_unraisable("a handler of Weir's messages");
  }
}

/// Whether a change of these parameters takes a reset to take effect.
bool takesReset(const Configurable& owner, const Value& values) {
  for (const auto& [name, value] : values.asObject()) {
    const Property* property = owner.findProperty(name);
    if (property == nullptr || property->spec().live) continue;
    if (property->group() == nullptr || !value.isObject() || takesReset(*property->group(), value))
      return true;
  }
  return false;
}

Error noSuch(const std::string& what, const std::string& name, const std::vector<std::string>& names) {
  return sceneError("there is no " + what + " " + inQuotes(name),
                    names.empty() ? "nothing: there are none" : joinNames(names), didYouMean(name, names));
}

Place placeOf(const Target& target) {
  switch (target.kind) {
    case Target::Kind::kWorld:
      return {"", "/world", ""};
    case Target::Kind::kSection:
      return {"", "/" + target.name, ""};
    case Target::Kind::kNode:
      return {"", "/nodes/" + target.name + "/params", ""};
    case Target::Kind::kModule:
      return {"", "/nodes/" + target.name + "/modules/" + target.module + "/params", ""};
  }
  return {};
}

/// Makes relative paths among written parameters absolute.
void makeAbsolute(const Configurable& owner, Value* parameters, const fs::path& folder) {
  if (parameters == nullptr || !parameters->isObject()) return;
  for (auto& [name, value] : parameters->asObject()) {
    const Property* property = owner.findProperty(name);
    if (property->kind() == "path" && value.isString() && !value.asString().empty())
      value = Value((folder / value.asString()).lexically_normal().string());
    if (property->group() == nullptr) continue;
    if (value.isArray())
      for (Value& item : value.asArray()) makeAbsolute(*property->group(), &item, folder);
    else
      makeAbsolute(*property->group(), &value, folder);
  }
}

void makeAbsolute(Scene& scene, Value& root, const fs::path& folder) {
  if (Value* plugins = root.find("plugins"))
    for (Value& file : plugins->asArray())
      file = Value((folder / file.asString()).lexically_normal().string());
  for (const auto& node : scene.graph.nodes()) {
    Value* written = root["nodes"].find(node->name());
    makeAbsolute(*node, written->find("params"), folder);
    if (Value* modules = written->find("modules"))
      for (auto& [name, module] : modules->asObject())
        makeAbsolute(*node->pipeline()->find(name), module.find("params"), folder);
  }
  for (const auto& [name, section] : scene.sections) makeAbsolute(*section, root.find(name), folder);
}

}  // namespace

PythonScene::PythonScene(std::shared_ptr<Library> library, std::unique_ptr<Scene> scene,
                         const std::string& folder)
    : library_(std::move(library)),
      folder_(folder.empty() ? fs::path() : fs::absolute(folder)),
      log_(logToPython),
      scene_(std::move(scene)) {
  registry();
  attachParts();
}

PythonScene::~PythonScene() = default;

const std::shared_ptr<const Registry>& PythonScene::registry() {
  if (registries_.empty() || registries_.back() != library_->registry())
    registries_.push_back(library_->registry());
  return registries_.back();
}

PythonScene::Stepping::Stepping(PythonScene& scene) : scene_(scene) {
  scene.checkFree();
  if (scene.isStepping())
    throw usageError("the simulation is within a step", "stepping when the present step has ended");
  scene.stepping_ = std::this_thread::get_id();
}

void PythonScene::checkFree() const {
  if (stepping_ && *stepping_ != std::this_thread::get_id())
    throw usageError("another thread is stepping this scene", "waiting until it has ended its step");
}

Scene& PythonScene::scene() const {
  checkFree();
  return simulation_ ? simulation_->scene() : *scene_;
}

Node& PythonScene::node(const std::string& name) const {
  if (Node* found = scene().graph.find(name)) return *found;
  std::vector<std::string> names;
  for (const auto& node : scene().graph.nodes()) names.push_back(node->name());
  throw noSuch("node", name, names);
}

PipelineBase& PythonScene::pipeline(const std::string& name) const {
  Node& owner = node(name);
  if (PipelineBase* found = owner.pipeline()) return *found;
  throw sceneError("a " + std::string(owner.info().type) + " has no modules", "a node that has modules")
      .inNode(name);
}

Module& PythonScene::module(const std::string& node, const std::string& name) const {
  PipelineBase& modules = pipeline(node);
  return *modules.modules()[modules.indexOf(name)];
}

ParticleSet& PythonScene::particles(const std::string& name) const {
  for (OutputPort* output : node(name).outputs()) {
    if (output->typeName() != weir::Particles::kPortType) continue;
    const weir::Particles& found = *static_cast<Output<weir::Particles>&>(*output);
    if (found.exist()) return found.set();
    throw usageError("there are no particles yet", "a weir.Simulation of the scene, which makes them")
        .inNode(name);
  }
  throw usageError("the node puts out no particles", "the node of a fluid or of other particles")
      .inNode(name);
}

void PythonScene::addNode(std::unique_ptr<Node> node, const std::string& name, const Value& parameters) {
  Scene& to = scene();
  if (to.sections.contains(name))
    throw sceneError(inQuotes(name) + " is the name of a section of scenes", "another name for the node");
  try {
    node->assignAll(parameters, placeOf({Target::Kind::kNode, name, ""}));
  } catch (Error& e) {
    throw e.inNode(name);
  }
  to.graph.add(std::move(node), name);
  attachParts();
  if (simulation_) staleBecause = "the new node " + inQuotes(name);
}

void PythonScene::give(const std::string& name, nb::dict arrays) {
  giveArrays(node(name), std::move(arrays));
  if (simulation_) staleBecause = "the new arrays of " + inQuotes(name);
}

void PythonScene::link(const std::string& text) {
  scene().graph.link(SceneGraph::parseLink(text));
  if (simulation_) staleBecause = "the new link " + inQuotes(text);
}

Configurable& PythonScene::find(const Target& target) const {
  switch (target.kind) {
    case Target::Kind::kNode:
      return node(target.name);
    case Target::Kind::kModule:
      return module(target.name, target.module);
    case Target::Kind::kSection: {
      const auto section = scene().sections.find(target.name);
      if (section == scene().sections.end()) throw noSuch("section", target.name, {});
      return *section->second;
    }
    case Target::Kind::kWorld:
      break;
  }
  return scene().world;
}

Value PythonScene::get(const Target& target, const std::vector<std::string>& path) const {
  const Configurable* owner = &find(target);
  const Property* property = nullptr;
  for (const std::string& name : path) {
    property = owner != nullptr ? owner->findProperty(name) : nullptr;
    if (property == nullptr) throw noSuch("parameter", name, {});
    owner = property->group();
  }
  WEIR_CHECK(property != nullptr);
  return property->value();
}

void PythonScene::assign(const Target& target, const Value& values) {
  Configurable& owner = find(target);
  const bool ofWorld = target.kind == Target::Kind::kWorld;
  const Value* duration = ofWorld ? values.find("duration") : nullptr;
  // A simulation can be made longer while it runs; its clock checks that.
  if (simulation_ && duration != nullptr && duration->isNumber()) {
    simulation_->setDuration(duration->asDouble());
    if (values.asObject().size() == 1) return;
  }
  if (target.kind == Target::Kind::kModule && assignMoved(target, values)) return;
  try {
    owner.assignAll(values, placeOf(target));
  } catch (Error& e) {
    if (!ofWorld && target.kind != Target::Kind::kSection) e.inNode(target.name);
    throw;
  }
  noteChange(owner, target, values);
}

bool PythonScene::assignMoved(const Target& target, const Value& values) {
  Module& before = module(target.name, target.module);
  Value params = before.changedValues();
  for (const auto& [name, value] : values.asObject()) params[name] = value;
  // One that is as the node has it by default is what a scene means that names no type.
  const bool asMade = pipeline(target.name).changedValues().find(target.module) == nullptr;
  std::string type = asMade ? std::string() : std::string(before.info().type);
  if (!readMoved(target.name, target.module, type, params)) return false;
  try {
    if (type == before.info().type) {
      before.assignAll(params, placeOf(target));
      noteChange(before, target, params);
      return true;
    }
    std::unique_ptr<Module> made = registry()->createModule(type);
    made->assignAll(params, placeOf(target));
    made->enable(before.enabled());
    insertModule(target.name, std::move(made), target.module, {});
  } catch (Error& e) {
    throw e.inNode(target.name);
  }
  return true;
}

bool PythonScene::readMoved(const std::string& node, const std::string& name, std::string& type,
                            Value& params) {
  Value modules = Value::object();
  if (!type.empty()) modules[name]["type"] = type;
  modules[name]["params"] = params;
  std::vector<std::string> warnings;
  const Place place{"", "/nodes/" + node + "/modules", ""};
  modules = withMovedParameters(std::move(modules), pipeline(node), *registry(), place, warnings);
  for (const std::string& warning : warnings) log().warn(warning);
  const Value* now = modules.find(name)->find("type");
  const bool another = now != nullptr && now->asString() != type;
  if (another) type = now->asString();
  params = *modules.find(name)->find("params");
  return another || !warnings.empty();
}

void PythonScene::noteChange(const Configurable& of, const Target& target, const Value& values) {
  if (!simulation_ || target.kind == Target::Kind::kSection || !takesReset(of, values)) return;
  std::vector<std::string> names;
  for (const auto& [name, value] : values.asObject()) names.push_back(name);
  const std::string owner = target.kind == Target::Kind::kWorld ? "world"
                            : target.module.empty()             ? target.name
                                                                : target.name + "." + target.module;
  staleBecause = "the change of " + owner + "." + joinNames(names, " and ");
}

void PythonScene::insertModule(const std::string& node, std::unique_ptr<Module> module,
                               const std::string& name, std::optional<std::size_t> index) {
  PipelineBase& modules = pipeline(node);
  if (!isName(name))
    throw sceneError(inQuotes(name) + " is not a valid name for a module",
                     "letters, digits, '_' and '-', starting with a letter");
  if (index)
    modules.insert(*index, std::move(module), name);
  else
    modules.replace(name, std::move(module));
  attachParts();
  if (simulation_) staleBecause = "the new module " + inQuotes(node + "." + name);
}

void PythonScene::attachParts() {
  for (const auto& node : scene().graph.nodes()) {
    if (auto* python = dynamic_cast<PythonNode*>(node.get())) python->attachTo(*this);
    if (node->pipeline() == nullptr) continue;
    for (const auto& module : node->pipeline()->modules())
      if (auto* python = dynamic_cast<PythonModule*>(module.get())) python->attachTo(*this, node->name());
  }
}

Value PythonScene::written(const std::string& folder) const {
  Value root = sceneToValue(scene());
  std::error_code error;
  if (!folder.empty() && !folder_.empty() &&
      fs::weakly_canonical(folder, error) != fs::weakly_canonical(folder_, error))
    makeAbsolute(scene(), root, folder_);
  return root;
}

std::string PythonScene::toJson(const std::string& folder,
                                const std::map<std::string, std::string>& files) const {
  Value root = written(folder);
  for (const std::string& name : nodesWithArrays(scene())) {
    const auto file = files.find(name);
    if (file == files.end())
      throw usageError("the node holds arrays, which the text of a scene cannot",
                       "save(path) of the scene, which writes them to files beside it")
          .inNode(name);
    Value& params = root["nodes"][name]["params"];
    if (!params.isObject()) params = Value::object();
    params["file"] = file->second;
    const auto* particles = dynamic_cast<const ParticleFile*>(&node(name));
    if (particles == nullptr || particles->given()->columns.empty()) continue;
    params["attributes"] = Value::array();
    for (const ParticleColumn& column : particles->given()->columns)
      params["attributes"].push(column.info.name);
  }
  return writeJson(root);
}

void PythonScene::openDeviceOnce(const std::string& device, int threads) {
  if (device_ && (device != deviceAskedFor_ || threads != threadsAskedFor_))
    throw usageError("the scene has been simulated on another device, or with other threads",
                     "device=" + inQuotes(deviceAskedFor_) + ", threads=" + std::to_string(threadsAskedFor_),
                     "scene.copy() makes a scene that can be simulated elsewhere");
  if (!device_) device_ = openDevice(device, threads);
  deviceAskedFor_ = device;
  threadsAskedFor_ = threads;
}

std::uint64_t PythonScene::simulate(const std::string& device, int threads) {
  openDeviceOnce(device, threads);
  endSimulation();
  static_cast<void>(clockOf(scene()));  // so that nothing is lost by what is thrown for it
  for (const auto& node : scene().graph.nodes())
    if (node->pipeline() != nullptr)
      for (const auto& module : node->pipeline()->modules()) module->validate();
  if (scene_->text.empty()) scene_->text = writeJson(written(""));
  simulation_ = std::make_unique<Simulation>(std::move(scene_), *device_, log_, *registry());
  staleBecause.clear();
  return ++number_;
}

void PythonScene::endSimulation() {
  checkFree();
  if (isStepping()) throw usageError("the simulation is within a step", "ending it when the step has ended");
  if (!simulation_) return;
  scene_ = simulation_->release();
  simulation_.reset();
}

}  // namespace weir::python
