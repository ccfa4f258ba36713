#include <weir/plugin.h>

#include "vortex_force.h"

WEIR_PLUGIN("vortex_force", "A vortex that swirls a fluid.", registry) {
  registry.addModule<vortex_force::VortexForce>();
}
