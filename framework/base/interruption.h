// Ending a run early: Ctrl-C, a polite kill, or a terminal that is closed.
#pragma once

#include <atomic>

namespace weir {

/// While it lives, SIGINT, SIGTERM and SIGHUP ask the run to end at its next step. A second SIGINT or SIGTERM
/// ends the program at once, as it would have without this. A SIGHUP that nohup has switched off stays so,
/// and a second one, which many terminals send, changes nothing. A file that may not grow any more (SIGXFSZ)
/// ends nothing: the write to it fails, and whoever writes says so.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// Of the last one that was made; those who wait for another program look at it, too.
  static const std::atomic<bool>& asked();
};

}  // namespace weir
