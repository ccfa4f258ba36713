// Particles that are not a fluid: points without mass that drift in a given flow, a Lamb-Oseen vortex.
//
// A tracer at the distance r from the axis turns about it at the rate
//
//   Ω(r) = Γ/(2π·r²)·(1 − exp(−r²/a²)),
//
// so it stays on its circle, and a step turns it by Ω·dt whatever dt is. What the node puts out are
// Particles: pictures, exports, the studio and Python treat the tracers as they treat a fluid.
#pragma once

#include <memory>

#include <weir/node.h>
#include <weir/particles.h>

namespace tracers {

using namespace weir;

class VortexTracers final : public Node {
 public:
  static constexpr NodeInfo kInfo{"VortexTracers", "Points without mass that drift in a vortex."};
  const NodeInfo& info() const override { return kInfo; }

  Param<float> spacing{
      *this,
      "spacing",
      0.02f,
      {.unit = "m", .min = 0, .aboveMin = true, .doc = "Distance of tracers at the start, and their size."}};
  Param<Vec3f> center{*this, "center", {}, {.unit = "m", .doc = "A point on the vortex's axis."}};
  Param<Vec3f> axis{*this, "axis", {0, 1, 0}, {.doc = "Direction of that axis; of any length but 0."}};
  Param<float> circulation{*this, "circulation", 1, {.unit = "m^2/s", .doc = "Circulation far away."}};
  Param<float> core{
      *this, "core", 0.1f, {.unit = "m", .min = 0, .aboveMin = true, .doc = "Radius of the core, a."}};

  Inputs<ParticleBatch> initial{*this, "initial", "Where the tracers start.", true};
  Output<Particles> particles{*this, "particles", "The tracers."};

  void validate() const override;
  void configure(const SetupContext& context) override;
  void estimate(const SetupContext& context, MemoryNeeds& needs) override;
  void reset(const SetupContext& context) override;
  void step(const StepContext& context) override;
  void report(NodeReport& report) override;
  std::int64_t particleCount() const override { return *set_ ? (*set_)->bound() : 0; }

 private:
  void drift(Device& device, double dt);
  template <class Backend>
  void driftOn(Backend& device, float dt);

  State<std::unique_ptr<ParticleSet>> set_{*this, "tracers"};
  Attribute<float> revolutions_;  // an attribute of the set
};

}  // namespace tracers
