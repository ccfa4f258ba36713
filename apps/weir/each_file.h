// Commands that do the same with each of several files.
#pragma once

#include <string>
#include <vector>

#include "apps/weir/program.h"

namespace weir::app {

/// What --check ends with where a file would be changed.
inline constexpr int kWouldChange = 1;

/// Calls `work`, which returns an exit code, with each file. An Error is logged, and the next file follows.
/// Returns the first error's exit code, or else the first code that is not kDone.
template <class Work>
int forEachFile(Program& program, const std::vector<std::string>& files, const Work& work) {
  int failed = kDone, other = kDone;
  for (const std::string& file : files) {
    try {
      const int code = work(file);
      if (other == kDone) other = code;
    } catch (const Error& e) {
      program.log().error(e.what());
      if (failed == kDone) failed = exitCode(e.kind());
    }
  }
  return failed != kDone ? failed : other;
}

}  // namespace weir::app
