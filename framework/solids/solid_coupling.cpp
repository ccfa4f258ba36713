#include "framework/solids/solid_coupling.h"

#include "framework/base/text.h"

namespace weir {

SolidCoupling& couplingOf(const Inputs<Particles>& particles, std::size_t i) {
  if (SolidCoupling* coupling = particles[i].coupling()) return *coupling;
  throw sceneError("the particles of " + inQuotes(particles.links()[i]->path()) + " meet no solids",
                   "a link from particles that do, such as those of a ParticleFluid");
}

}  // namespace weir
