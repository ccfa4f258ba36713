// Arrays that a module fills anew in every step.
#pragma once

#include "nodes/particle_fluid/fluid_module.h"

namespace weir {

/// Makes each array as long as those of the particles, on the fluid's device; contents are undefined.
template <class... T>
void fitScratch(FluidStep& fluid, Array<T>&... arrays) {
  const auto fit = [&](auto& array) {
    if (array.data() == nullptr) array = std::remove_reference_t<decltype(array)>(fluid.device);
    array.resizeDiscarding(fluid.particles.capacity());
  };
  (fit(arrays), ...);
}

}  // namespace weir
