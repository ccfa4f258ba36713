// A watch over the processes of a launch: one that is stopped, or whose machine does not respond, ends all.
// How long work takes does not matter, as a thread of its own answers.
#pragma once

#include <mpi.h>

#include <functional>
#include <memory>
#include <string>

namespace weir {

/// Each rank tells the next one every second that it is there, and watches the one before it.
class RankWatch {
 public:
  /// Called once, on a thread of the watch, with what to tell the user of the rank that has been silent for
  /// ten seconds.
  using Silent = std::function<void(const std::string& what)>;

  /// All ranks take part, of an MPI that may be called by several threads at once.
  explicit RankWatch(Silent silent);
  /// When all ranks have come here. Where an error travels, nobody may.
  ~RankWatch();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace weir
