#include <weir/plugin.h>

#include "dfsph.h"

WEIR_PLUGIN("dfsph", "Divergence-free SPH, in place of the fluid's solver.", registry) {
  registry.addModule<dfsph::Dfsph>();
}
