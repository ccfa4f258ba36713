// Finds what a fluid meets, in every step, for white water to meet the same.
#pragma once

#include <vector>

#include "framework/base/api.h"
#include "framework/particles/sink_region.h"
#include "framework/solids/solid.h"
#include "nodes/static_boundary/boundary.h"

namespace WEIR_API weir {

class ParticleFluid;
struct FluidWalls;

class WallsOfFluid {
 public:
  /// For reset(). `fluid` is null for particles that meet nothing; `removed`, on the device, counts what its
  /// sinks take.
  WallsOfFluid(Device& device, const ParticleFluid* fluid, int* removed);

  /// For step(), after the fluid's. `poses` are those at the end of the last step, or none: a body that
  /// forces move may have been moved on by its node already, so it cannot be asked where it was.
  void place(double time, double dt, Array<Pose>& poses);
  FluidWalls view() const;

 private:
  void findBoundaries(int* removed);
  template <class Backend>
  void placeBodiesOn(Backend& device, Array<Pose>& poses, bool known);

  const ParticleFluid* fluid_;
  Array<BoundaryPiece> pieces_;
  BoundaryView boundary_;
  Array<SinkPiece> sinks_;
  Array<SolidView> solids_;
};

}  // namespace weir
