// What walls do to the volume of water, found from the heights at which it rests in tanks of several sizes.
//
// Square tanks are filled as samplers fill them, with fluid without order, for which the calibration
// `packing` is made, and come to rest. Twice the height of the centre of mass is the height of the water.
// Over that of the water's volume it would be 1 if walls held the water just where its volume ends. If they
// hold it too far away by o spacings, it is, to first order,
//
//   1 + o·(4/W + 2/h)
//
// in a tank of the width W and a water of the height h, in spacings: four sides are missing o in width each,
// and the floor lifts the centre of mass. Edges, where two walls meet, and the free surface differ, too, but
// less; o is the least squares fit to tanks from 8 to 16 spacings wide, such that water in those stands as
// high as it should on the whole. (One of 20 would take longer than all others together, and weigh 5 %.)
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "framework/compute/device.h"
#include "framework/graph/registry.h"
#include "framework/graph/scene_graph.h"

namespace weir {
class ParticleFluid;
}

namespace weir::test {

struct Tank {
  int width = 0, height = 0;  ///< spacings, the height is that of the water
};

/// The tanks that calibrations are found from.
std::vector<Tank> calibrationTanks();

struct TankWater {
  double supportRatio = 1.5;
  bool mesh = false;        ///< walls of SemiAnalyticalSFI, else of StaticBoundary
  double tolerance = 1e-3;  ///< mean compression; it takes 1/γ as much of the volume (settledResponse)
  std::int64_t seed = 1;
};

/// Water in a tank, brought to rest.
class RestingTank {
 public:
  RestingTank(Device& device, const Tank& tank, const TankWater& water);

  /// Twice the height of the centre of mass over the height of the water's volume.
  double height() const;

  /// Lets the water move for that many seconds, with nothing but walls and gravity to hold it. With a factor
  /// a, walls of a mesh push with that one from now on: over the first half of the time it changes evenly, as
  /// water that is kicked stays looser than it was.
  void settle(double seconds, std::optional<double> wallFactor = {});

 private:
  Device& device_;
  Tank tank_;
  Log log_;
  Registry registry_;
  SceneGraph graph_;
  ParticleFluid* fluid_;
  std::int64_t steps_ = 0;
};

/// o, spacings, by which walls hold water too far away. heights[k] is that in tanks[k].
double wallOffset(const std::vector<Tank>& tanks, const std::vector<double>& heights);

}  // namespace weir::test
