// A rectangular nozzle. A layer is a square lattice of width/spacing times height/spacing particles, both
// rounded.
#pragma once

#include "framework/base/api.h"
#include "nodes/emitters/nozzle_emitter.h"

namespace WEIR_API weir {

class SquareEmitter final : public NozzleEmitter {
 public:
  static constexpr NodeInfo kInfo{"SquareEmitter",
                                  "A rectangular nozzle that emits a jet of particles along its -y axis.",
                                  "jet, nozzle, sheet, inflow, inlet, source, pour, curtain"};
  const NodeInfo& info() const override { return kInfo; }

  Param<float> width{*this,
                     "width",
                     0.1f,
                     {.unit = "m",
                      .min = 0,
                      .aboveMin = true,
                      .doc = "Size along the nozzle's x axis, rounded to whole particles."}};
  Param<float> height{*this,
                      "height",
                      0.1f,
                      {.unit = "m",
                       .min = 0,
                       .aboveMin = true,
                       .doc = "Size along the nozzle's z axis, rounded to whole particles."}};

 protected:
  double area() const override { return double(width) * height; }
  double layerSize(float spacing) const override;
  Layer makeLayer(const SetupContext& context, float spacing) const override;
};

}  // namespace weir
