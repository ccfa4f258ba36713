// A flat nozzle: an emitter whose layers lie in a plane that can be placed and turned.
//
// The nozzle spans the node's local x and z axes around its position; the jet leaves along local -y. Turning
// it moves its points rigidly, so their distances stay the fluid's spacing. Where keyframes move it,
// particles leave with the speed of the jet alone: that of the nozzle is not added.
//
// A layer is a square lattice with the outline of the nozzle. For a fluid whose rest state is disordered, its
// particles are moved from there, differently in each layer, as in a RelaxedTile: the jet is then a piece of
// fluid at rest, where layers of lattices would be too dense and spray. What comes out of equilibrium where
// the nozzle cuts it moves aside as the jet flies, in each repetition alike: the tile is four times as long
// as it is wide, as the jet had a rib for each of its 12 layers where it was a cube.
#pragma once

#include "framework/base/api.h"
#include "framework/particles/arrangement.h"
#include "nodes/emitters/emitter.h"

namespace WEIR_API weir {

class NozzleEmitter : public Emitter {
 public:
  Param<Vec3f> position{
      *this, "position", {}, {.unit = "m", .live = true, .animated = true, .doc = "Centre of the nozzle."}};
  Param<Rotation> rotation{*this,
                           "rotation",
                           {},
                           {.unit = "degrees",
                            .live = true,
                            .animated = true,
                            .doc = "Turns the nozzle; without it the jet points down (-y)."}};

  Param<std::optional<Arrangement>> arrangement{
      *this,
      "arrangement",
      std::nullopt,
      {.doc = "If it is left out: relaxed for fluids with the calibration `packing`, else lattice."}};

 protected:
  Frame axes() const final {
    const Quatf q = rotation->toQuaternion();
    return {position, rotate(q, {1, 0, 0}), rotate(q, {0, 1, 0}), rotate(q, {0, 0, 1})};
  }
  static constexpr int kTileHeight = 4 * kTileSide;
  int layersMade() const final { return isRelaxed(arrangement, request()) ? kTileHeight : 1; }
  /// Layers with particles at or near the nodes (x, 0, z) of a square lattice.
  Layer layersOf(const SetupContext& context, const std::vector<Vec3f>& nodes) const;
};

}  // namespace weir
