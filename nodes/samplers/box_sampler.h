// A box full of particles.
#pragma once

#include "framework/base/api.h"
#include "nodes/samplers/sampler.h"

namespace WEIR_API weir {

class BoxSampler final : public Sampler {
 public:
  static constexpr NodeInfo kInfo{"BoxSampler", "Fills a box with particles.",
                                  "block, cube, dam, dam break, column, initial, fill, water"};
  const NodeInfo& info() const override { return kInfo; }

  Param<Vec3f> min{*this, "min", {}, {.unit = "m", .doc = "Lower corner."}};
  Param<Vec3f> max{*this,
                   "max",
                   {0.5f, 0.5f, 0.5f},
                   {.unit = "m", .doc = "Upper corner. The particles fill the box's volume."}};

  void validate() const override;
  void reset(const SetupContext& context) override;

 protected:
  double maxParticleCount() const override;

 private:
  Lattice lattice() const;
};

}  // namespace weir
