#include "python/src/python_module.h"

#include <nanobind/stl/string.h>

#include "nodes/particle_fluid/modules/neighbor_search.h"
#include "python/src/errors.h"
#include "python/src/particles.h"
#include "python/src/python_scene.h"
#include "python/src/stream_order.h"
#include "python/src/values.h"

namespace weir::python {

namespace {

constexpr const char* kState = "python";

/// What a method of a Python module gets. It can be used until the method returns.
class StepView {
 public:
  StepView(FluidStep& step, const PythonModule& module)
      : step_(&step), particles_(module.scene()->shared_from_this(), module.node()) {}

  const FluidStep& step() const {
    if (step_ == nullptr)
      throw usageError("the fluid of a module is used after its method has returned",
                       "the fluid's node, or what the method is given the next time");
    return *step_;
  }
  const Particles& particles() const {
    static_cast<void>(step());
    return particles_;
  }
  void end() { step_ = nullptr; }

 private:
  FluidStep* step_;
  Particles particles_;
};

}  // namespace

std::string docOf(nb::handle type) {
  const nb::object doc = nb::module_::import_("inspect").attr("cleandoc")(nb::str(type.attr("__doc__")));
  return type.attr("__doc__").is_none() ? std::string() : nb::cast<std::string>(doc);
}

PythonModule::PythonModule(ModuleBase& half, ModuleTexts texts)
    : half_(half), texts_(std::move(texts)), info_{texts_.type, kFamily, texts_.doc} {}

PythonModule::~PythonModule() {
  const nb::gil_scoped_acquire gil;
  half_.module_ = nullptr;
  self_.reset();  // the other half may go with it
}

void PythonModule::attach(PythonScene& scene, std::string node) {
  scene_ = &scene;
  node_ = std::move(node);
}

template <class T>
void PythonModule::addParam(const std::string& name, nb::handle initial, ParamSpec spec) {
  const T value = ParamTraits<T>::fromValue(toValue(initial), spec, {});
  auto param = std::make_unique<Param<T>>(*this, name, value, spec);
  getters_[name] = [p = param.get()] { return ParamTraits<T>::toValue(p->get()); };
  parameters_.push_back(std::move(param));
}

void PythonModule::define(const PythonParameter& p, nb::handle initial) {
  const auto keep = [&](const std::string& text) -> std::string_view { return strings_.emplace_back(text); };
  const ParamSpec spec{.unit = keep(p.unit),
                       .min = p.min,
                       .max = p.max,
                       .aboveMin = p.aboveMin,
                       .live = p.live,
                       .animated = p.animated,
                       .doc = keep(p.doc)};
  const Value value = toValue(initial);
  ParamSpec plain = spec;
  plain.animated = false;
  try {
    if (value.isBool()) return addParam<bool>(p.name, initial, plain);
    if (value.isInt()) return addParam<std::int64_t>(p.name, initial, plain);
    if (value.isNumber()) return addParam<double>(p.name, initial, spec);
    if (value.isString()) return addParam<std::string>(p.name, initial, plain);
    if (value.isArray() && value.asArray().size() == 2) return addParam<Vec2f>(p.name, initial, plain);
    if (value.isArray() && value.asArray().size() == 3) return addParam<Vec3f>(p.name, initial, spec);
  } catch (Error& e) {
    throw e.inParameter(p.name);
  }
  throw nb::type_error(
      ("the parameter '" + p.name + "' begins as none of bool, int, float, str, or two or three numbers")
          .c_str());
}

nb::object PythonModule::get(const std::string& name) const {
  const auto getter = getters_.find(name);
  if (getter == getters_.end()) throw nb::attribute_error(name.c_str());
  return toPython(getter->second(), true);
}

bool PythonModule::comesAfterSearch() const {
  for (const auto& module : scene_->pipeline(node_).modules()) {
    if (module.get() == this) return false;
    if (module->enabled() && dynamic_cast<const NeighborSearch*>(module.get()) != nullptr) return true;
  }
  return false;
}

void PythonModule::call(const char* method, FluidStep& fluid, bool withDt) {
  const nb::gil_scoped_acquire gil;
  letStreamWait(fluid.device, kLegacyStream);
  const nb::object view = nb::cast(StepView(fluid, *this));
  scene_->running = {.node = node_, .knowsNeighbors = withDt && comesAfterSearch()};
  struct End {
    StepView& view;
    PythonScene& scene;
    ~End() {
      view.end();
      scene.running.reset();
    }
  } end{nb::cast<StepView&>(view), *scene_};
  if (withDt)
    self_.attr(method)(view, fluid.time.dt);
  else
    self_.attr(method)(view);
  waitForStream(fluid.device, kLegacyStream);
}

void PythonModule::reset(FluidStep& fluid) {
  call("reset", fluid, false);
}

void PythonModule::step(FluidStep& fluid) {
  call("step", fluid, true);
}

void PythonModule::report(NodeReport& report) {
  const nb::gil_scoped_acquire gil;
  const nb::object said = self_.attr("report")();
  if (said.is_none()) return;
  const Value values = toValue(said);
  if (!values.isObject()) throw nb::type_error("report() of a module returns a dict");
  for (const auto& [name, value] : values.asObject()) report.statistics[name] = value;
}

void PythonModule::save(const StateWriter& to) const {
  const nb::gil_scoped_acquire gil;
  const nb::bytes state = nb::cast<nb::bytes>(self_.attr("_saved_state")());
  to.put(kState, std::span<const char>(state.c_str(), state.size()));
}

void PythonModule::restore(const StateReader& from) {
  const std::vector<char> state = from.getAll<char>(kState);
  const nb::gil_scoped_acquire gil;
  self_.attr("_restore_state")(nb::bytes(state.data(), state.size()));
}

PythonModule& ModuleBase::module() const {
  if (module_ == nullptr)
    throw usageError("the module has no parameters",
                     "a module that called super().__init__(), and whose scene is still there");
  return *module_;
}

void ModuleBase::begin(ModuleTexts texts) {
  if (module_ != nullptr) throw usageError("the module is made already", "one call of __init__");
  own_ = std::make_unique<PythonModule>(*this, std::move(texts));
  module_ = own_.get();
}

std::unique_ptr<Module> ModuleBase::give(nb::object self) {
  static_cast<void>(module());
  if (!own_) throw usageError("the module is in a scene already", "another object for another place");
  own_->keep(std::move(self));
  return std::move(own_);
}

std::unique_ptr<Module> makePythonModule(nb::handle type) {
  const nb::gil_scoped_acquire gil;
  nb::object made = type();
  ModuleBase& half = nb::cast<ModuleBase&>(made);
  return half.give(std::move(made));
}

void bindModule(nb::module_& m) {
  nb::class_<ModuleBase>(m, "ModuleBase", "What weir.Module is made of.", nb::dynamic_attr())
      .def(nb::init<>())
      .def(
          "_begin",
          [](ModuleBase& b, std::string type, std::string doc) {
            b.begin({std::move(type), std::move(doc)});
          },
          nb::arg("type"), nb::arg("doc"))
      .def(
          "_define",
          [](ModuleBase& b, std::string name, nb::handle initial, std::string unit, std::string doc,
             double min, double max, bool above, bool live, bool animated) {
            b.module().define(
                {std::move(name), std::move(unit), std::move(doc), min, max, above, live, animated}, initial);
          },
          nb::arg("name"), nb::arg("initial"), nb::arg("unit"), nb::arg("doc"), nb::arg("min"),
          nb::arg("max"), nb::arg("above"), nb::arg("live"), nb::arg("animated"))
      .def(
          "_get", [](const ModuleBase& b, const std::string& name) { return b.module().get(name); },
          nb::arg("name"))
      .def(
          "_assign",
          [](const ModuleBase& b, nb::handle values) {
            PythonModule& module = b.module();
            if (module.scene() == nullptr) return module.assignAll(toValue(values), {});
            module.scene()->assign({Target::Kind::kModule, module.node(), module.name()}, toValue(values));
          },
          nb::arg("values"))
      .def_prop_ro(
          "name", [](const ModuleBase& b) { return b.module().name(); },
          "Its name in the pipeline; \"\" outside.")
      .def_prop_rw(
          "enabled", [](const ModuleBase& b) { return b.module().enabled(); },
          [](ModuleBase& b, bool on) { b.module().enable(on); }, "Whether it takes part in steps.");

  nb::class_<StepView>(m, "FluidStep",
                       "A fluid within one step, as a module's methods get it; gone when they return.")
      .def_prop_ro(
          "particles", [](const StepView& v) { return v.particles(); }, "The particles with all attributes.")
      .def_prop_ro(
          "positions", [](const StepView& v) { return v.particles().array("position"); },
          nb::sig("def positions(self) -> numpy.ndarray | DeviceArray"),
          "Positions, m: predicted ones between the modules predict and solver.")
      .def_prop_ro(
          "velocities", [](const StepView& v) { return v.particles().array("velocity"); },
          nb::sig("def velocities(self) -> numpy.ndarray | DeviceArray"), "Velocities, m/s.")
      .def(
          "__getitem__", [](const StepView& v, const std::string& name) { return v.particles().array(name); },
          nb::arg("name"), nb::sig("def __getitem__(self, name: str) -> numpy.ndarray | DeviceArray"),
          "An attribute of the particles.")
      .def(
          "neighbors", [](const StepView& v) { return v.particles().neighbors(); },
          nb::sig("def neighbors(self) -> tuple[numpy.ndarray | DeviceArray, numpy.ndarray | DeviceArray]"),
          "Offsets and indices of the neighbours of all particles, see Particles.neighbors(); for modules "
          "after the search.")
      .def_prop_ro(
          "count", [](const StepView& v) { return v.particles().count(); }, "How many particles there are.")
      .def_prop_ro(
          "time", [](const StepView& v) { return v.step().time.time; }, "When the step begins, s.")
      .def_prop_ro(
          "dt", [](const StepView& v) { return v.step().time.dt; }, "How long the step is, s.")
      .def_prop_ro(
          "index", [](const StepView& v) { return v.step().time.index; }, "The number of the step, from 0.")
      .def_prop_ro(
          "gravity",
          [](const StepView& v) {
            return toPython(ParamTraits<Vec3f>::toValue(v.step().time.gravity), true);
          },
          nb::sig("def gravity(self) -> tuple[float, float, float]"), "Acceleration, m/s^2.")
      .def_prop_ro(
          "spacing", [](const StepView& v) { return v.step().constants.spacing; }, "Of particles at rest, m.")
      .def_prop_ro(
          "support_radius", [](const StepView& v) { return v.step().constants.supportRadius; },
          "Within which particles interact, m.")
      .def_prop_ro(
          "kernel_at_0", [](const StepView& v) { return v.step().constants.kernel.value0; },
          "W(0), 1/m^3, of the kernel W(r) = W(0) (1 - r/H)^3 that densities are sums of; H is the support "
          "radius.")
      .def_prop_ro(
          "rest_density", [](const StepView& v) { return v.step().constants.restDensity; }, "kg/m^3.")
      .def_prop_ro(
          "particle_mass", [](const StepView& v) { return v.step().constants.particleMass; }, "kg.")
      .def_prop_ro(
          "device", [](const StepView& v) { return v.step().device.name(); }, "\"cpu\" or \"cuda:0\".")
      .def_prop_ro(
          "stream", [](const StepView& v) { return streamOf(v.step().device); },
          "The CUDA stream of the simulation, as a number; 0 on the CPU. Work in it and in the default "
          "stream "
          "comes in the right order by itself.");
}

}  // namespace weir::python
