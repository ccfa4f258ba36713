// A vortex: swirls the fluid about an axis with the velocity profile of a Lamb-Oseen vortex as acceleration,
//
//   a = growth/(2π·s)·(1 − exp(−s²/core²))·t,     t = axis × s/|s|
//
// where s is the distance from the axis, and t the direction around it. Far from the core the acceleration
// falls off as that of a free vortex whose circulation grows by `growth` m²/s²; within it the fluid is turned
// like a rigid body.
#pragma once

#include <weir/fluid_module.h>
#include <weir/ranks.h>

namespace vortex_force {

using namespace weir;

// Each particle is pushed by itself, so any division of the fluid among ranks is right.
class VortexForce final : public FluidModule, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{"VortexForce", kFamily,
                                    "Swirls the fluid about an axis; insert it before \"predict\"."};
  const ModuleInfo& info() const override { return kInfo; }

  Param<Vec3f> center{
      *this, "center", {}, {.unit = "m", .live = true, .animated = true, .doc = "A point on the axis."}};
  Param<Vec3f> axis{
      *this, "axis", {0, 1, 0}, {.live = true, .doc = "Direction of the axis; of any length but 0."}};
  Param<float> growth{*this,
                      "growth",
                      1,
                      {.unit = "m^2/s^2",
                       .softMin = -10,
                       .softMax = 10,
                       .live = true,
                       .animated = true,
                       .doc = "Growth of the circulation far from the core; negative turns the other way."}};
  Param<float> core{*this,
                    "core",
                    0.1f,
                    {.unit = "m", .min = 0, .aboveMin = true, .live = true, .doc = "Radius of the core."}};

  void validate() const override;
  /// Adds the attribute "swirl".
  void reset(FluidStep& fluid) override;
  void step(FluidStep& fluid) override {
    dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);

  Attribute<Vec3f> swirl_;  // of the fluid's particles
};

}  // namespace vortex_force
