// Registers a type under the name of another one.

#include <weir/plugin.h>

#include "tests/support/test_nodes.h"

namespace {

class Impostor final : public weir::Node {
 public:
  static constexpr weir::NodeInfo kInfo{"ParticleFluid", "Takes a name that is taken."};
  const weir::NodeInfo& info() const override { return kInfo; }
  void reset(const weir::SetupContext&) override {}
};

}  // namespace

WEIR_PLUGIN("taken_name", "Takes a name that is taken.", registry) {
  registry.addNode<Impostor>();
}
