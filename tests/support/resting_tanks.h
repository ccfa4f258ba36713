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
// less; o is the least squares fit to tanks from 8 to 20 spacings wide, such that water in those stands as
// high as it should on the whole.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "framework/compute/device.h"

namespace weir::test {

struct Tank {
  int width = 0, height = 0;  ///< spacings, the height is that of the water
};

/// The tanks that calibrations are found from.
std::vector<Tank> calibrationTanks();

struct TankWater {
  double supportRatio = 1.5;
  bool mesh = false;                 ///< walls of SemiAnalyticalSFI, else of StaticBoundary
  std::optional<double> wallFactor;  ///< a, in place of the one that the fluid has; then give it seconds
  double seconds = 0;                ///< after it has been brought to rest
  std::int64_t seed = 1;
};

/// The height of water at rest in a tank over that of its volume.
double restingHeight(Device& device, const Tank& tank, const TankWater& water);

/// o, spacings, by which walls hold water too far away. heights[k] is that in tanks[k].
double wallOffset(const std::vector<Tank>& tanks, const std::vector<double>& heights);

}  // namespace weir::test
