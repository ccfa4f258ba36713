// Calls what no library has.
#include "framework/graph/plugin.h"

void nobodyHasThis();

WEIR_PLUGIN("missing_symbol", "Cannot be linked.", registry) {
  (void)registry;
  nobodyHasThis();
}
