// Types that fail where they are told to, as a plugin with mistakes would.
#include <stdexcept>

#include "framework/base/check.h"
#include "framework/graph/plugin.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/particle_fluid.h"

namespace {

using namespace weir;

struct NoException {};

void failIf(bool fails, const std::string& hook) {
  if (fails) throw std::runtime_error("mistake in " + hook);
}

class FailingNode final : public Node {
 public:
  static constexpr NodeInfo kInfo{"FailingNode", "Fails in one of its functions."};
  const NodeInfo& info() const override { return kInfo; }
  Param<std::string> hook{*this, "hook", "", {.doc = "The function that fails."}};

  void configure(const SetupContext&) override { failIf(*hook == "configure", "configure"); }
  void reset(const SetupContext&) override { failIf(*hook == "reset", "reset"); }
  void step(const StepContext&) override {
    failIf(*hook == "step", "step");
    if (*hook == "step_no_exception") throw NoException{};
    if (*hook == "step_check") WEIR_CHECK(1 == 2);
    if (*hook == "step_error") throw simulationError("mistake in step_error");
  }
  void frame(const StepContext&) override { failIf(*hook == "frame", "frame"); }
};

class FailingModule final : public FluidModule {
 public:
  static constexpr ModuleInfo kInfo{"FailingModule", kFamily, "Fails in one of its functions."};
  const ModuleInfo& info() const override { return kInfo; }
  Param<std::string> hook{*this, "hook", "", {.doc = "The function that fails."}};

  void reset(FluidStep&) override { failIf(*hook == "reset", "reset"); }
  void warn(const FluidOutlook&) const override { failIf(*hook == "warn", "warn"); }
  void step(FluidStep&) override { failIf(*hook == "step", "step"); }
};

class FailsAtBirth final : public Node {
 public:
  static constexpr NodeInfo kInfo{"FailsAtBirth", "Cannot be made."};
  const NodeInfo& info() const override { return kInfo; }
  FailsAtBirth() { failIf(true, "the constructor"); }
  void reset(const SetupContext&) override {}
};

}  // namespace

WEIR_PLUGIN("failing_hooks", "Fails where it is told to.", registry) {
  registry.addNode<FailingNode>();
  registry.addNode<FailsAtBirth>();
  registry.addModule<FailingModule>();
}
