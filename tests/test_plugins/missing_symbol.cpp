// Calls what no library has.

#include <weir/plugin.h>

void nobodyHasThis();

WEIR_PLUGIN("missing_symbol", "Cannot be linked.", registry) {
  (void)registry;
  nobodyHasThis();
}
