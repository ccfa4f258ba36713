// A flat nozzle: an emitter whose layers lie in a plane that can be placed and turned.
//
// The nozzle spans the node's local x and z axes around its position; the jet leaves along local -y. Turning
// it moves its points rigidly, so their distances stay the fluid's spacing. Where keyframes move it,
// particles leave with the speed of the jet alone: that of the nozzle is not added.
#pragma once

#include "nodes/emitters/emitter.h"

namespace weir {

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

 protected:
  Frame axes() const final {
    const Quatf q = rotation->toQuaternion();
    return {position, rotate(q, {1, 0, 0}), rotate(q, {0, 1, 0}), rotate(q, {0, 0, 1})};
  }
  /// A layer of points (x, 0, z).
  static Layer layerOf(std::vector<Vec3f> points) {
    std::vector<Vec3f> directions(points.size(), Vec3f{0, -1, 0});
    return {std::move(points), std::move(directions)};
  }
};

}  // namespace weir
