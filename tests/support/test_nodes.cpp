#include "tests/support/test_nodes.h"

namespace weir::test {

void registerTestTypes(Registry& registry) {
  registry.setSource("tests");
  registry.addNode<Source>();
  registry.addNode<NeedsFile>();
  registry.addNode<Relay>();
  registry.addNode<Sum>();
  registry.addNode<Worker>();
  registry.addModule<AddRule>();
  registry.addModule<ScaleRule>();
  registry.addModule<Stranger>();
  registry.addSection<Stage>("stage", "How the scene is shown.");
}

}  // namespace weir::test
