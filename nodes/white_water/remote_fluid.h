// Where ranks share a fluid: the particles of other ranks near those that a rank asks about, which are its
// own and all points of its slab.
//
// A halo of the fluid's own (DividedParticles) reaches as far as its solver does, and shows what was there
// before the step. Here is what is there now, as far as a normal of a neighbour sees. Who has what near whom
// goes by layers of cells: each rank tells in which its particles are, and in which it wants to see others'.
#pragma once

#include <vector>

#include "framework/base/api.h"
#include "framework/communication/communicator.h"
#include "framework/communication/slabs.h"
#include "nodes/white_water/fluid_grid.h"

namespace WEIR_API weir {

class RemoteFluid {
 public:
  RemoteFluid(Communicator& ranks, Device& device)
      : ranks_(ranks), found_(device), foundCount_(device, 1), points_(device) {}
  ~RemoteFluid();
  RemoteFluid(const RemoteFluid&) = delete;
  RemoteFluid& operator=(const RemoteFluid&) = delete;

  /// Fetches them; all ranks do so at once. `own` are the fluid's particles that this rank has, in `box`, and
  /// whoever is within `reach` (m) of these or of the slab is seen.
  void fetch(const Particles& own, const Aabb& box, const Slabs& slabs, float reach);
  /// Until the next fetch().
  ArrayView<const FluidPoint> points() const { return points_.view(); }

 private:
  /// Of layers; none at first.
  struct Layers {
    int first = 1, last = 0;
    bool empty() const { return first > last; }
    bool meet(const Layers& o) const { return !empty() && !o.empty() && first <= o.last && o.first <= last; }
    void extend(const Layers& o);
  };
  struct Ask {
    Layers has, wants;
  };
  Ask askOf(const Aabb& box, const Slabs& slabs, float reach) const;
  Parcel packed(const Particles& own, const CellLayers& layers, const Layers& wanted);
  template <class Backend>
  std::int64_t findWantedOn(Backend& device, const Particles& own, const CellLayers& layers,
                            const Layers& wanted);
  template <class Backend>
  void packOn(Backend& device, const Particles& own, ArrayView<FluidPoint> to);
  void take();
  void release();

  Communicator& ranks_;
  Array<int> found_, foundCount_;
  Array<FluidPoint> points_;
  std::vector<Parcel> parcels_;  // which the device may still be reading
};

}  // namespace weir
