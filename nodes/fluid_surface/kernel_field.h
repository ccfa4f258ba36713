// The sum of the particles' kernels on a sparse grid.
//
// Each particle is listed at every block that its ellipsoid's box touches; lists are sorted by block, and
// each block adds up its own list in the order of the particles. So the sums are the same for any number of
// threads, and a block exists wherever a cell has a corner that is not zero.
#pragma once

#include "framework/base/api.h"
#include "nodes/fluid_surface/particle_kernels.h"
#include "nodes/fluid_surface/sparse_grid.h"

namespace WEIR_API weir {

class KernelField {
 public:
  explicit KernelField(Device& device)
      : counts_(device),
        keys_(device),
        particles_(device),
        heads_(device),
        headCount_(device, 1),
        pairCount_(device, 1),
        grid_(device) {}

  /// How far particles may be from the origin along each axis, m.
  static float farthest(float cellSize, float kernelRadius);

  /// Bytes on the device for that many particles in fluid that hangs together, with the mesh; kernels and
  /// cells in spacings. Spray takes more, as each drop has blocks of its own.
  static double memoryFor(double particles, double kernelRadius, double cellSize);

  /// Makes the grid and its values. Throws a simulation Error where it would have more nodes than can be
  /// counted. Waits for the device.
  void make(Device& device, const ParticleKernels& kernels, float cellSize);

  const SparseGrid& grid() const { return grid_; }

 private:
  template <class Backend>
  void countOn(Backend& device, const ParticleKernels& kernels, float cellSize);
  template <class Backend>
  void listOn(Backend& device, const ParticleKernels& kernels, float cellSize, std::int64_t pairs);
  template <class Backend>
  void sumOn(Backend& device, const ParticleKernels& kernels, std::int64_t pairs);

  Array<int> counts_;          // of each particle: its blocks, then the place of its first pair
  Array<std::uint64_t> keys_;  // of each pair
  Array<int> particles_;       // of each pair
  Array<int> heads_;           // the first pair of each block
  Array<int> headCount_;
  Array<std::int64_t> pairCount_;
  SparseGrid grid_;
};

}  // namespace weir
