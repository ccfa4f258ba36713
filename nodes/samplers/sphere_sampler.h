// A sphere full of particles.
#pragma once

#include "framework/base/api.h"
#include "nodes/samplers/sampler.h"

namespace WEIR_API weir {

class SphereSampler final : public Sampler {
 public:
  static constexpr NodeInfo kInfo{"SphereSampler", "Fills a sphere with particles.",
                                  "ball, drop, droplet, initial, fill, water"};
  const NodeInfo& info() const override { return kInfo; }
  SphereSampler() : Sampler(StartPressure::kNone) {}

  Param<Vec3f> center{*this, "center", {0, 0.5f, 0}, {.unit = "m", .doc = "Its centre."}};
  Param<float> radius{
      *this,
      "radius",
      0.25f,
      {.unit = "m", .min = 0, .aboveMin = true, .doc = "No particle is farther from the centre."}};

  void reset(const SetupContext& context) override;

 protected:
  double maxParticleCount() const override;

 private:
  /// With a particle at the centre, and in the middle of eight, two or four.
  std::vector<Lattice> lattices() const;
};

}  // namespace weir
