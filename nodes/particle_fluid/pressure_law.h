// The role of the module that knows how the fluid resists compression.
#pragma once

#include "nodes/particle_fluid/bulk_energy.h"

namespace weir {

/// The first enabled module of the pipeline that has it is asked, from its reset on.
class PressureLaw {
 public:
  virtual const BulkEnergy& bulkEnergy() const = 0;

 protected:
  ~PressureLaw() = default;
};

}  // namespace weir
