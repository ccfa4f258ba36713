// Ending a run early: Ctrl-C, or a polite kill.
#pragma once

#include <atomic>

namespace weir::app {

/// While it lives, SIGINT and SIGTERM ask the run to end at its next step. A second signal ends the program
/// at once, as it would have without this.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  const std::atomic<bool>& asked() const;
};

}  // namespace weir::app
