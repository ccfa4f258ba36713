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

PythonModule::PythonModule(PartBase& half, PartTexts texts)
    : PythonPart(*this, half, std::move(texts)), info_{this->texts().type, kFamily, this->texts().doc} {}

void PythonModule::attachTo(PythonScene& scene, std::string node) {
  attach(scene);
  node_ = std::move(node);
}

bool PythonModule::comesAfterSearch() const {
  for (const auto& module : scene()->pipeline(node_).modules()) {
    if (module.get() == this) return false;
    if (module->enabled() && dynamic_cast<const NeighborSearch*>(module.get()) != nullptr) return true;
  }
  return false;
}

void PythonModule::callIn(const char* method, FluidStep& fluid, bool withDt) {
  const nb::gil_scoped_acquire gil;
  letStreamWait(fluid.device, kLegacyStream);
  const nb::object view = nb::cast(StepView(fluid, *this));
  scene()->running = {.node = node_, .knowsNeighbors = withDt && comesAfterSearch()};
  struct End {
    StepView& view;
    PythonScene& scene;
    ~End() {
      view.end();
      scene.running.reset();
    }
  } end{nb::cast<StepView&>(view), *scene()};
  if (withDt)
    call(method, view, fluid.time.dt);
  else
    call(method, view);
  waitForStream(fluid.device, kLegacyStream);
}

void PythonModule::reset(FluidStep& fluid) {
  callIn("reset", fluid, false);
}

void PythonModule::step(FluidStep& fluid) {
  callIn("step", fluid, true);
}

void bindModule(nb::module_& m) {
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
