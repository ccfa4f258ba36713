#include "nodes/particle_fluid/initial_batches.h"

#include <algorithm>
#include <cmath>

#include "framework/graph/memory_estimate.h"

namespace weir {

std::vector<SharedBatch> sharedBatches(const Inputs<ParticleBatch>& initial, bool isShared) {
  std::vector<SharedBatch> batches;
  for (std::size_t i = 0; i < initial.size(); ++i)
    batches.push_back({&initial[i], isShared ? partOf(*initial.links()[i]) : nullptr});
  return batches;
}

double memoryOfBatches(const Inputs<ParticleBatch>& initial, int ranks) {
  double bytes = 0;
  for (const auto& [batch, part] : sharedBatches(initial, true))
    bytes += part != nullptr ? bytesOfArray(std::ceil(batch->maxCount / ranks), sizeof(Vec3f))
                             : bytesOfArray(batch->maxCount, sizeof(Vec3f) + sizeof(int));
  return bytes;
}

bool holdsParts(const Inputs<ParticleBatch>& initial) {
  bool anyRests = false, anyIsHeld = false;
  for (const OutputPort* link : initial.links())
    if (const auto* maker = dynamic_cast<const MadeByRanks*>(&link->node()))
      (maker->rests() ? anyRests : anyIsHeld) = true;
  return anyRests && anyIsHeld;
}

void releaseBatches(const Inputs<ParticleBatch>& initial, Device& device, bool comesToRest) {
  const std::vector<SharedBatch> batches = sharedBatches(initial, true);
  const bool rests = comesToRest && std::ranges::any_of(batches, [](const SharedBatch& of) {
                       return of.batch->container != nullptr;
                     });
  for (std::size_t i = 0; i < batches.size(); ++i) {
    const auto& [batch, part] = batches[i];
    if (initial.links()[i]->links().size() > 1 || (rests && part == nullptr)) continue;
    batch->positions = Array<Vec3f>(device);
    batch->velocities = Array<Vec3f>(device);
    if (part != nullptr) part->runs = {};
  }
}

}  // namespace weir
