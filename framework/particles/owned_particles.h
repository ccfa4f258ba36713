// The role of nodes whose particles several ranks share: what they put out are all particles, as they were at
// the last frame, on rank 0; what a rank owns is here at any time.
#pragma once

#include <string_view>

#include "framework/base/api.h"
#include "framework/communication/slabs.h"
#include "framework/particles/particle_set.h"

namespace WEIR_API weir {

/// Below which name of the node's state they stand in a checkpoint: ParticleSet::save(). On several ranks
/// Node::save() has all but the rows (DividedParticles::save), which each rank saves for itself.
inline constexpr std::string_view kSavedParticles = "particles";

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
