// Fluid at rest, as a pattern that fills space: an arrangement without order, one particle in each d³, that
// repeats itself along all axes.
//
// Where the pressure p is the same everywhere, the force between two particles is −2·p·V0²·∇W. So fluid at
// rest under pressure is a local minimum of the sum of W over all pairs at a fixed volume, and which one it
// is found in, coming from motion, is a disordered one. A tile is such a minimum: a cubic lattice whose
// nodes are moved at random, then downhill. Every particle belongs to a node, so a tile is a field of
// displacements, and any region that is cut out of it has exactly as many particles as nodes.
#pragma once

#include <cstdint>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

class CpuThreads;

class RelaxedTile {
 public:
  /// `side`³ particles (side ≥ 1 + 2·supportRatio), for a support of H = supportRatio·d, after `sweeps`
  /// steps downhill; the same for any number of threads.
  RelaxedTile(double supportRatio, int side, int sweeps, std::uint64_t seed, CpuThreads& threads)
      : RelaxedTile(supportRatio, side, side, sweeps, seed, threads) {}
  /// `height` of them along y.
  RelaxedTile(double supportRatio, int side, int height, int sweeps, std::uint64_t seed, CpuThreads& threads);

  int height() const { return sides_.y; }

  /// How far the particle of a node is from it, in spacings. Nodes count on for ever, in both directions.
  Vec3f displacement(std::int64_t x, std::int64_t y, std::int64_t z) const;

  /// Mean over the particles of Σ_j (1 − r/H)³, the particle itself included.
  double meanSum() const { return meanSum_; }

 private:
  /// Gives particles nodes near to them.
  void assignToNodes();
  void relax(double supportRatio, int sweeps, CpuThreads& threads);

  Vec3i sides_;
  std::vector<Vec3d> positions_;  // spacings, not wrapped
  double meanSum_ = 0;
};

/// The s with which the tile's mean density is the rest density.
double calibrationOf(const RelaxedTile& tile, double supportRatio);

}  // namespace weir
