// What a periodic domain asks of a scene.
//
// The domain's opposite faces along some axes are one: what leaves through the one comes in through the
// other, and particles see each other through it (framework/particles/periodic_images.h). Two dimensions are
// had with a thin domain that is periodic along the third axis.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "framework/base/api.h"
#include "framework/base/log.h"
#include "framework/graph/param_types.h"
#include "framework/particles/particle_batch.h"
#include "framework/particles/period.h"
#include "framework/solids/solid.h"
#include "nodes/static_boundary/boundary.h"

namespace WEIR_API weir {

enum class PeriodicAxes { kNone, kX, kY, kZ, kXy, kXz, kYz, kXyz };
template <>
struct EnumNames<PeriodicAxes> {
  static constexpr std::array<EnumName, 8> kNames{
      EnumName{"none", "No faces are joined."}, EnumName{"x", "Those across x."},
      EnumName{"y", "Those across y."},         EnumName{"z", "Those across z."},
      EnumName{"xy", "Those across x and y."},  EnumName{"xz", "Those across x and z."},
      EnumName{"yz", "Those across y and z."},  EnumName{"xyz", "All."}};
};

/// The period along these axes of a domain. Throws a scene Error if the domain has no such faces, or if they
/// are nearer than two support radii (m), so that a particle would meet another from both sides.
Period periodOf(PeriodicAxes axes, const std::optional<Vec3f>& low, const std::optional<Vec3f>& high,
                float supportRadius);

/// Throw a scene Error unless the solid looks the same through the faces, as far as its bounds tell: along
/// each axis of the period it must end `reach` (m) before both faces or go on that far behind both. `named`
/// says which solid it is.
void checkSolid(const Period& period, const BoundaryPiece& piece, float reach, const std::string& named);
void checkSolid(const Period& period, const SolidView& solid, float reach, const std::string& named);

/// Throws a scene Error if particles of the batch are outside of the period's box.
void checkBatch(const Period& period, const ParticleBatch& batch, const std::string& named);

}  // namespace weir
