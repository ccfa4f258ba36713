#include "nodes/particle_fluid/modules/conjugate.h"

#include "framework/graph/memory_estimate.h"

namespace weir {

void ConjugateDirections::reserve(Device& device, std::int64_t particles, bool walls) {
  if (directionSums.data() == nullptr) {
    directionSums = Array<DirectionSums>(device, 1);
    lineSums = Array<LineSums>(device, 1);
    for (Array<Vec3f>* const each : {&direction_, &tried_, &gradient_, &previous_})
      *each = Array<Vec3f>(device);
    for (Array<float>* const each : {&excess_, &triedExcess_, &share_, &shareChange_})
      *each = Array<float>(device);
  }
  for (Array<Vec3f>* const each : {&direction_, &tried_, &gradient_, &previous_})
    each->resizeDiscarding(particles);
  for (Array<float>* const each : {&excess_, &triedExcess_}) each->resizeDiscarding(particles);
  for (Array<float>* const each : {&share_, &shareChange_}) each->resizeDiscarding(walls ? particles : 0);
}

double ConjugateDirections::memoryFor(double particles, bool walls) const {
  return bytesOfArrays(particles, direction_, tried_, gradient_, previous_, excess_, triedExcess_) +
         (walls ? bytesOfArrays(particles, share_, shareChange_) : 0);
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
          .shareChange = shareChange_.view()};
}

}  // namespace weir
