// Sorts the particles and finds the neighbours that the modules behind it use.
#pragma once

#include "framework/communication/on_ranks.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace weir {

class NeighborSearch final : public FluidModule, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{"NeighborSearch", kFamily,
                                    "Sorts particles by cell and lists the neighbours of each, once a step.",
                                    "neighbours, grid, cells, hash"};
  const ModuleInfo& info() const override { return kInfo; }

  void step(FluidStep& fluid) override { fluid.findNeighbors(); }
};

}  // namespace weir
