// Ending a run early: Ctrl-C, a polite kill, a terminal that is closed, or the warning of a queue.
#pragma once

#include <atomic>
#include <exception>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// What SIGUSR1 asks for, which queues send some time before they end a job.
enum class OnWarning {
  kEnd,   ///< the same as SIGTERM
  kSave,  ///< to save, and then to end: warned()
};

/// While it lives, SIGINT, SIGTERM and SIGHUP ask the run to end at its next step. A second SIGINT or SIGTERM
/// ends the program at once, as it would have without this. A SIGHUP that nohup has switched off stays so,
/// and a second one, which many terminals send, changes nothing. A file that may not grow any more (SIGXFSZ)
/// ends nothing: the write to it fails, and whoever writes says so.
class Interruption {
 public:
  Interruption();  ///< whose warnings end
  explicit Interruption(OnWarning onWarning);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// Of the last one that was made; those who wait for another program look at it, too.
  static const std::atomic<bool>& asked();
  /// Whether SIGUSR1 has come to the last one that was made, if that saves.
  static const std::atomic<bool>& warned();
};

/// What ends an InterruptibleWork.
class Interrupted final : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// While it lives, work of this thread that nobody has seen anything of yet, such as setting up a scene, may
/// end anywhere by Interrupted once an Interruption, or whoever wants the work, asks for it.
class InterruptibleWork {
 public:
  InterruptibleWork() : InterruptibleWork(nullptr) {}
  /// The work ends as well once `also` is true; null leaves that as it is.
  explicit InterruptibleWork(const std::atomic<bool>* also);
  ~InterruptibleWork();
  InterruptibleWork(const InterruptibleWork&) = delete;
  InterruptibleWork& operator=(const InterruptibleWork&) = delete;

  /// Throws Interrupted if this thread does such work and is asked to end; once, so that what cleans up
  /// behind it is not ended in turn. Whatever takes long calls it: parallel loops, waiting for other
  /// processes.
  static void endIfAsked();

 private:
  bool outer_;
  const std::atomic<bool>* outerAlso_;
};

}  // namespace weir
