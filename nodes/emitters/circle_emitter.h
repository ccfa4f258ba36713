// A round nozzle. A layer is a square lattice of the fluid's spacing, clipped to the disc: of its nodes, the
// round(π·radius²/spacing²) nearest to the centre. So a layer's particles stand for the disc's area up to
// half a particle, and none is farther out than the disc's rim by more than about half a spacing.
#pragma once

#include "framework/base/api.h"
#include "nodes/emitters/nozzle_emitter.h"

namespace WEIR_API weir {

class CircleEmitter final : public NozzleEmitter {
 public:
  static constexpr NodeInfo kInfo{"CircleEmitter",
                                  "A round nozzle that emits a jet of particles along its -y axis.",
                                  "jet, nozzle, tap, faucet, hose, inflow, inlet, source, pour, spray"};
  const NodeInfo& info() const override { return kInfo; }

  Param<float> radius{
      *this,
      "radius",
      0.05f,
      {.unit = "m",
       .min = 0,
       .aboveMin = true,
       .doc = "Radius of the nozzle. A layer has pi radius^2 / spacing^2 particles, rounded."}};

 protected:
  double area() const override;
  double layerSize(float spacing) const override;
  Layer makeLayer(const SetupContext& context, float spacing) const override;
};

}  // namespace weir
