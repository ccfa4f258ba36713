// Work in a copy of this process, for what may crash: other people's libraries, and plugins that nobody has
// loaded yet. A crash there is a fact here, not an end.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <sys/types.h>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// How the copy ended.
struct ForkedEnd {
  std::string bytes;         ///< what the work returned
  bool done = false;         ///< whether it returned
  int signal = 0;            ///< the signal that ended it, or 0
  int exitCode = 0;          ///< its exit code where it ended itself
  bool outOfTime = false;    ///< whether it used up its time
  bool outOfMemory = false;  ///< whether it asked for more memory than it may have
};

struct ForkedLimits {
  int cpuSeconds = 60;            ///< of processor time
  int seconds = 0;                ///< of the clock; 0 is without a limit
  std::uint64_t memoryBytes = 0;  ///< of address space beside what this process has; 0 is without a limit
  std::uint64_t resultBytes = 0;  ///< of what `work` returns; more ends the copy. 0 is without a limit
  bool writesFiles = true;        ///< whether it may write to files
  bool keepsStderr = false;       ///< whether what it prints on stderr is in `bytes`, too, or goes nowhere
};

/// A copy of this process, whose only thread runs `work`. Nothing that it does to memory is seen here.
class ForkedWork {
 public:
  /// Throws an io Error if the copy cannot be made. What `work` throws ends the copy by a signal.
  ForkedWork(const std::function<std::string()>& work, const ForkedLimits& limits);
  ~ForkedWork();
  ForkedWork(const ForkedWork&) = delete;
  ForkedWork& operator=(const ForkedWork&) = delete;

  /// Waits for its end; to be called once.
  ForkedEnd wait();

 private:
  pid_t child_ = -1;
  int pipe_ = -1;
  std::uint64_t resultBytes_;
};

}  // namespace weir
