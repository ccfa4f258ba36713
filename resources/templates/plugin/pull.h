// Pulls every particle to a point like a spring: v ← v + dt·a, a = rate²·(center − x).
//
// The centre of mass of a fluid on which nothing else acts then swings with the angular frequency `rate`.
#pragma once

#include <weir/fluid_module.h>

namespace my_plugin {

using namespace weir;

class Pull final : public FluidModule {
 public:
  static constexpr ModuleInfo kInfo{"MyPluginPull", kFamily,
                                    "Pulls the fluid to a point; insert it before \"predict\"."};
  const ModuleInfo& info() const override { return kInfo; }

  // One line is all that a parameter needs: scenes, checks, `weir nodes` and the JSON Schema follow from it.
  Param<Vec3f> center{
      *this, "center", {}, {.unit = "m", .live = true, .animated = true, .doc = "Where it pulls to."}};
  Param<float> rate{*this,
                    "rate",
                    3,
                    {.unit = "1/s",
                     .min = 0,
                     .softMax = 20,
                     .live = true,
                     .doc = "Angular frequency with which the fluid swings about the center."}};

  /// Adds the attribute "pull", which is sorted, exported and shown like the built-in ones.
  void reset(FluidStep& fluid) override {
    pull_ = fluid.particles.add<float>(
        {"pull", AttributeType::kFloat, "m/s^2", "Acceleration towards the center."});
  }
  void step(FluidStep& fluid) override {
    dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);

  Attribute<float> pull_;  // of the fluid's particles
};

}  // namespace my_plugin
