// How initial particles that ranks have made together come to those that they belong to.
//
//   const InitialDivision division = initialDivision(ranks, box, batches, cellSize);
//   divided.follow(division.slabs);
//   makeRoom(particles, division.own);
//   for (const SharedBatch& shared : batches)
//     if (shared.part != nullptr) appendPart(divided, particles, *shared.batch, *shared.part);
//
// All ranks make the same calls. No rank holds more than its part of what was made, its share of all, and a
// little that is on its way.
#pragma once

#include <vector>

#include "framework/particles/divided_particles.h"
#include "framework/particles/made_by_ranks.h"

namespace WEIR_API weir {

/// A batch, and what this rank has made of it; null where every rank has all.
struct SharedBatch {
  ParticleBatch* batch;
  BatchPart* part;

  std::int64_t countOfAll() const { return part != nullptr ? part->all : batch->count; }
};

struct InitialDivision {
  Slabs slabs;
  std::int64_t own = 0;  ///< particles in this rank's slab
};

/// As DividedParticles::cut() divides it: cells of that size, in m, for particles in this box of all ranks.
InitialDivision initialDivision(Communicator& ranks, const Aabb& box, const std::vector<SharedBatch>& batches,
                                float cellSize);

/// Adds a batch of which each rank has made a part to the set that the ranks share, in the slabs that its
/// particles belong to.
void appendPart(DividedParticles& divided, ParticleSet& particles, const ParticleBatch& batch,
                const BatchPart& part);

}  // namespace weir
