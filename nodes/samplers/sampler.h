// What all samplers have in common: they fill a region with particles at the spacing of the fluid below.
#pragma once

#include "framework/graph/node.h"
#include "nodes/particles/particle_batch.h"
#include "nodes/samplers/lattice.h"

namespace weir {

class Sampler : public Node {
 public:
  Param<Vec3f> velocity{*this, "velocity", {}, {.unit = "m/s", .doc = "Of all particles at the start."}};
  Param<float> jitter{*this,
                      "jitter",
                      0,
                      {.min = 0,
                       .max = 0.5,
                       .doc = "Moves each particle at random by up to this share of the spacing along each "
                              "axis."}};

  Output<ParticleBatch> particles{*this, "particles", "The particles, there from the start."};

  /// Those who read the particles have done so in reset() or in the first step.
  void step(const StepContext& context) final;
  void report(NodeReport& report) final;

 protected:
  /// What the fluid below asks for; throws a scene Error if there is none.
  float requestedSpacing() const;
  /// Puts out the nodes of the lattice that are inside; throws a scene Error if there are none.
  void fill(const SetupContext& context, const Lattice& lattice,
            const std::function<bool(const Vec3f&)>& inside = {});
  /// Warns if the particles put out fill much more or less than `volume` m³.
  void warnOfRounding(const SetupContext& context, double volume, float spacing) const;

  /// Warns of a region of that thickness, in m, if it has room for few particles across it only.
  void warnOfThinness(const SetupContext& context, double thickness, float spacing) const;

 private:
  std::int64_t sampled_ = 0;
};

}  // namespace weir
