#include "framework/particles/divided_particles.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace weir {

void FluidStep::findNeighbors() {
  if (divided == nullptr) return neighbors.build(particles, domain, sinks, images);
  divided->migrate();
  neighbors.fitMore(divided->ranks().sum(particles.bound()));  // which is exact now
  neighbors.sort(particles, domain, sinks);
  divided->showHalo(neighbors.sortedLayers());
  neighbors.list(particles);
}

void FluidStep::exchange(std::initializer_list<std::string_view> attributes) {
  if (divided != nullptr) divided->refresh(attributes);
  if (images != nullptr) images->refresh(attributes);
}

void FluidStep::exchange(ArrayView<float> values) {
  if (divided != nullptr) divided->refresh(values);
  if (images != nullptr) images->refresh(values);
}

void FluidStep::exchange(ArrayView<Vec3f> values) {
  if (divided != nullptr) divided->refresh(values);
  if (images != nullptr) images->refresh(values);
}

void FluidStep::exchange(ArrayView<Vec4f> values) {
  if (divided != nullptr) divided->refresh(values);
  if (images != nullptr) images->refresh(values);
}

}  // namespace weir
