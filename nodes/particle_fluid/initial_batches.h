// The initial batches of a fluid, and what ranks hold of them.
#pragma once

#include <vector>

#include "framework/particles/initial_division.h"

namespace weir {

/// In the order of their links; with parts where ranks share the fluid.
std::vector<SharedBatch> sharedBatches(const Inputs<ParticleBatch>& initial, bool isShared);

/// Bytes on the device of a rank, before there are lists: the places of what it has made, or of a batch that
/// every rank has, with the indices of those that belong to it.
double memoryOfBatches(const Inputs<ParticleBatch>& initial, int ranks);

/// Whether particles that no rank has all of are held while others come to rest: these take their places
/// along (RestState).
bool holdsParts(const Inputs<ParticleBatch>& initial);

/// Frees what a fluid on ranks has taken. By a batch that every rank has whole, a RestState to come knows
/// places and velocities.
void releaseBatches(const Inputs<ParticleBatch>& initial, Device& device, bool comesToRest);

}  // namespace weir
