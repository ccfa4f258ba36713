// What this plugin adds to Weir.

#include <weir/plugin.h>

#include "probe.h"
#include "pull.h"

WEIR_PLUGIN("my_plugin", "Pulls a fluid to a point, and counts particles.", registry) {
  registry.addModule<my_plugin::Pull>();
  registry.addNode<my_plugin::Probe>();
}
