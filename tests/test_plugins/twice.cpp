// Registers one name twice.

#include <weir/plugin.h>

#include "tests/support/test_nodes.h"

WEIR_PLUGIN("twice", "Registers one name twice.", registry) {
  registry.addNode<weir::test::Source>();
  registry.addNode<weir::test::Source>();
}
