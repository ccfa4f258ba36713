// What walls do to the volume of water that has settled, found from the heights at which it stands in tanks
// of several sizes.
//
// A block of water collapses in a square tank, splashes, and comes to rest, with iterations to a tolerance.
// Twice the height of its centre of mass, over the height that its volume would have in the tank, is
//
//   1 + b + o·(4/W + 2/h) + s/h
//
// where W and h are the tank's width and the water's height in spacings. b is what the bulk differs in
// volume, o the room that is missing at each wall (o > 0: the walls hold the water too far away), in
// spacings, and s what the free surface differs. The three have different shapes in W and h, so heights in a
// few tanks tell them apart. Nothing else of the settled water enters: not where its layers lie, nor how many
// iterations led there.
#pragma once

#include <optional>
#include <vector>

#include "framework/compute/device.h"

namespace weir::test {

struct Tank {
  int width = 0, height = 0;  ///< spacings, the height is that of the water; even
};

/// The tanks that calibrations are found from.
std::vector<Tank> calibrationTanks();

struct TankWater {
  double supportRatio = 1.5;
  bool fresh = false;  ///< fills the tank as relaxed by its sampler, instead of collapsing there
  bool mesh = false;   ///< walls of SemiAnalyticalSFI, else of StaticBoundary
  std::optional<double> wallFactor;  ///< a, in place of the one that the fluid has
  double seconds = 4;
  double jitter = 0.3;  ///< of the lattice that it starts as, where it collapses
  std::int64_t seed = 1;
};

/// Twice the height of the centre of mass of water that has settled in a tank, over its volume's height.
double settledHeight(Device& device, const Tank& tank, const TankWater& water);

struct WallFit {
  double bulk = 0, wall = 0, surface = 0;  ///< b, o, s
  double wallError = 0;                    ///< standard error of o
};

/// The least squares fit; heights[k] is that in tanks[k]. Four tanks at least.
WallFit fitWalls(const std::vector<Tank>& tanks, const std::vector<double>& heights);

}  // namespace weir::test
