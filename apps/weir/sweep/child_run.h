// A program that runs beside this one and ends where this one ends.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace weir::app {

/// How a program ended.
struct ChildEnd {
  int code = 0;    ///< its exit code, if no signal ended it
  int signal = 0;  ///< the signal that ended it, or 0
};

/// Runs in a process group of its own, so that Ctrl-C of the terminal does not reach it unasked. What it says
/// goes into a file, what it prints nowhere. Whatever ends this process, SIGTERM ends it.
class ChildRun {
 public:
  /// To be made by the main thread. Throws an io Error if the program cannot be started.
  ChildRun(const std::filesystem::path& program, const std::vector<std::string>& arguments,
           const std::filesystem::path& log);
  /// Asks it to end, and waits.
  ~ChildRun();
  ChildRun(const ChildRun&) = delete;
  ChildRun& operator=(const ChildRun&) = delete;

  /// How it ended; none while it runs.
  std::optional<ChildEnd> ended();
  void send(int signal) const;

 private:
  pid_t pid_ = -1;
  bool runs_ = false;
};

}  // namespace weir::app
