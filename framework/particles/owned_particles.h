// The role of nodes whose particles several ranks share: what they put out are all particles, as they were at
// the last frame, on rank 0; what a rank owns is here at any time.
#pragma once

#include "framework/base/api.h"
#include "framework/communication/slabs.h"
#include "framework/particles/particle_set.h"

namespace WEIR_API weir {

class OwnedParticles {
 public:
  /// Those of this rank, with the attributes of all; all of them where it is alone. From the reset on.
  virtual ParticleSet& owned() = 0;
  /// How ranks divide space among them; null where one is alone. Steps may leave particles beside the slab of
  /// their rank.
  virtual const Slabs* slabs() const = 0;

 protected:
  ~OwnedParticles() = default;
};

}  // namespace weir
