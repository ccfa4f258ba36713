// The role of the module that knows how the fluid resists compression.
#pragma once

#include <optional>

#include "nodes/particle_fluid/bulk_energy.h"

namespace weir {

/// The first enabled module of the pipeline that has it is asked, from its reset on.
class PressureLaw {
 public:
  virtual const BulkEnergy& bulkEnergy() const = 0;
  /// The mean of max(λ − 1, 0) that it leaves; nothing where it makes some iterations, whatever they come to.
  virtual std::optional<double> toleratedCompression() const { return {}; }

 protected:
  ~PressureLaw() = default;
};

}  // namespace weir
