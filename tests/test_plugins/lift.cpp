// A plugin as a user would write it: a module for the pipeline of a fluid.

#include <weir/fluid_module.h>
#include <weir/parallel.h>
#include <weir/plugin.h>

namespace {

using namespace weir;

/// Lifts everything at a given speed, so that a test can see that it ran.
class Lift final : public FluidModule {
 public:
  static constexpr ModuleInfo kInfo{"Lift", kFamily, "Sets the speed upwards."};
  const ModuleInfo& info() const override { return kInfo; }

  Param<float> speed{*this, "speed", 1, {.unit = "m/s", .doc = "Speed upwards."}};

  void step(FluidStep& fluid) override {
    const std::vector<Vec3f> up(static_cast<std::size_t>(fluid.particles.bound()), Vec3f{0, speed, 0});
    fluid.particles.velocities().assign(up);
  }
};

}  // namespace

WEIR_PLUGIN("lift", "Lifts a fluid.", registry) {
  registry.addModule<Lift>();
}
