// The extension weir._core. What users see of it is in weir/*.py.
#include <nanobind/nanobind.h>

#include "python/src/errors.h"
#include "python/src/library.h"
#include "python/src/particles.h"
#include "python/src/python_module.h"
#include "python/src/python_node.h"
#include "python/src/python_part.h"
#include "python/src/python_scene.h"
#include "python/src/python_simulation.h"
#include "python/src/walls.h"

NB_MODULE(_core, m) {
  namespace nb = nanobind;
  using namespace weir::python;
  m.doc() = "The compiled part of Weir.";
  // A module that refers to its own scene is a cycle that ends with the process; nobody needs to be told.
  nb::set_leak_warnings(false);
  raiseErrorsAs(nb::module_::import_("weir._errors").attr("Error"));
  bindLibrary(m);
  bindParticles(m);
  bindPart(m);
  bindModule(m);
  bindWalls(m);
  bindScene(m);
  bindNode(m);
  bindSimulation(m);
}
