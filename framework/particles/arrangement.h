// How the particles of a source lie before the fluid moves them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "framework/base/api.h"
#include "framework/graph/param_types.h"
#include "framework/particles/particle_batch.h"
#include "framework/particles/relaxed_tile.h"

namespace WEIR_API weir {

class Device;

enum class Arrangement { kRelaxed, kLattice };
template <>
struct EnumNames<Arrangement> {
  static constexpr std::array<EnumName, 2> kNames{EnumName{"relaxed", "Disordered, as in fluid at rest."},
                                                  EnumName{"lattice", "A cubic lattice."}};
};

/// Whether a source shall use a tile: as it is told, or else as its fluid's rest state is.
bool isRelaxed(const std::optional<Arrangement>& told, const ParticleBatch::Request& request);

/// Particles along the tile of sources.
inline constexpr int kTileSide = 12;

/// The tile of sources: small and quickly made, as more of either changes nothing that can be seen in a
/// block. `height`: particles along y. The last ones that the process made are kept, so that ranks and
/// runs that start anew do not make them again.
std::shared_ptr<const RelaxedTile> tileOfSource(const ParticleBatch::Request& request, std::uint64_t seed,
                                                const Device& device, int height = kTileSide);

}  // namespace weir
