// Adds a type and then fails; the registry must be as before.
#include <stdexcept>

#include <weir/plugin.h>

#include "tests/support/test_nodes.h"

WEIR_PLUGIN("throws", "Fails to register.", registry) {
  registry.addNode<weir::test::Source>();
  throw std::runtime_error("no licence found");
}
