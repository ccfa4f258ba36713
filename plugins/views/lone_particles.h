// Which particles of a fluid are by themselves.
#pragma once

#include <cstdint>

#include "framework/base/vec.h"
#include "framework/compute/array.h"

namespace weir::rendering {

/// A particle is lone if there is at most one more in the 2 x 2 x 2 cells of 1.5 spacings around it, which
/// hold 27 in full fluid, 9 of a layer and 3 of a thread.
///
/// Particles are counted by cell in a count-min sketch (G. Cormode and S. Muthukrishnan, Journal of
/// Algorithms 55, 2005), which needs no bounds of the fluid: of three tables, each by another hash, the least
/// count of a cell is taken. It is never too small; where it is too large, in about 3 of 1,000 of them, a
/// lone particle is taken for one of the others. A grid that wraps around (framework/neighbors/cell_grid.h)
/// would not do, as drops that fly high share its cells with the water below.
class LoneParticles {
 public:
  explicit LoneParticles(Device& device)
      : device_(device), counts_(device), lone_(device), others_(device), kept_(device, 2) {}

  /// Of particles that are `spacing` (m) apart in fluid. What is not finite is one of the others. Waits for
  /// the device.
  void find(ArrayView<const Vec3f> positions, float spacing);

  /// Their numbers, in order.
  ArrayView<const int> lone() const { return lone_.view(); }
  ArrayView<const int> others() const { return others_.view(); }

 private:
  template <class Backend>
  void findOn(Backend& device, ArrayView<const Vec3f> positions, float cell);

  Device& device_;
  Array<std::uint32_t> counts_;  // the tables, one behind the other
  Array<int> lone_, others_, kept_;
};

}  // namespace weir::rendering
