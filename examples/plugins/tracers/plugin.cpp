#include <weir/plugin.h>

#include "tracers.h"

WEIR_PLUGIN("tracers", "Particles that are not a fluid: tracers in a vortex.", registry) {
  registry.addNode<tracers::VortexTracers>();
}
