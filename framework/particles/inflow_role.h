// The role of nodes whose particles flow in as one body, as out of a pipe.
#pragma once

#include <cstdint>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// A fluid carries on the newest layers of such a node as they were given, until others are behind them.
/// Alone, the last layer would give way to the pressure of those before it; the next one would then be put
/// too near to it, and so on, until the jet bursts.
class FlowsIn {
 public:
  virtual ~FlowsIn() = default;
  /// Of the particles that it gave in this step, in their order.
  struct Flow {
    double speed = 0;    ///< m/s; 0 for none that shall be carried
    double leaving = 0;  ///< s after the step began, when the first of them do
    std::int64_t together =
        1;  ///< so many do at a time; the next ones when the flow has moved on by a spacing
  };
  virtual Flow flow() const = 0;
};

}  // namespace weir
