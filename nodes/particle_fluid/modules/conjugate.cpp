#include "nodes/particle_fluid/modules/conjugate.h"

#include "framework/graph/memory_estimate.h"
#include "nodes/particle_fluid/scratch.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

void ConjugateDirections::reserve(FluidStep& fluid) {
  if (directionSums.data() == nullptr) {
    directionSums = Array<DirectionSums>(fluid.device, 1);
    lineSums = Array<LineSums>(fluid.device, 1);
  }
  fitScratch(fluid, direction_, tried_, gradient_, previous_, excess_, triedExcess_);
  if (fluid.walls.keepsShares()) fitScratch(fluid, share_, shareChange_);
  if (fluid.walls.reports() || fluid.walls.curves) fitScratch(fluid, heldDirection_, heldChange_);
}

double ConjugateDirections::memoryFor(double particles, bool walls, bool held) const {
  return bytesOfArrays(particles, direction_, tried_, gradient_, previous_, excess_, triedExcess_) +
         (walls ? bytesOfArrays(particles, share_, shareChange_) : 0) +
         (held ? bytesOfArrays(particles, heldDirection_, heldChange_) : 0);
}

void ConjugateDirections::release() {
  *this = {};
}

ConjugateView ConjugateDirections::view() {
  return {.direction = direction_.view(),
          .tried = tried_.view(),
          .gradient = gradient_.view(),
          .previous = previous_.view(),
          .excess = excess_.view(),
          .triedExcess = triedExcess_.view(),
          .share = share_.view(),
          .shareChange = shareChange_.view(),
          .heldDirection = heldDirection_.view(),
          .heldChange = heldChange_.view()};
}

}  // namespace weir
