// Another program that is fed through its standard input, such as an encoder.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace weir::rendering {

/// How long a program may hold this one up. Once the run was asked to end (Interruption), one that shows no
/// sign of life, which is to take input or processor time, has kAfterInterruption.
struct ProgramLimits {
  static constexpr std::chrono::seconds kAfterInterruption{3};

  std::chrono::milliseconds idle;  ///< without taking input while there is some
  std::chrono::milliseconds end;   ///< from the end of its input to its own
};

/// How long something has not happened. Time in which this program itself was stopped (Ctrl-Z) does not
/// count.
class Waiting {
 public:
  void restart() { *this = {}; }
  /// To be asked several times a second.
  std::chrono::nanoseconds time();

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::chrono::nanoseconds waited_{};
};

/// The program runs in a process group of its own, so that a Ctrl-C in the terminal does not end it: it ends
/// when its input does. Its output is appended to a file, or kept with its messages; what it writes to stderr
/// is read while write() and finish() run, so that neither waits for the other forever. One that is beyond
/// its limits is killed. A broken pipe raises no SIGPIPE here. Use from one thread at a time, except for
/// cancel().
class PipedProgram {
 public:
  /// Where a program's output goes that nobody wants.
  static constexpr const char* kNowhere = "/dev/null";

  /// Looks for the program on the PATH. `output` is a file that is there; "": it is kept with the messages.
  /// Throws std::system_error: no_such_file_or_directory if there is no such program.
  PipedProgram(const std::string& program, const std::vector<std::string>& arguments,
               const ProgramLimits& limits, const std::filesystem::path& output = kNowhere);
  /// Kills the program, and what it has started in its group, if it has not ended.
  ~PipedProgram();
  PipedProgram(const PipedProgram&) = delete;
  PipedProgram& operator=(const PipedProgram&) = delete;

  /// False if the program takes no more input, is beyond its limit, or cancel() was called.
  bool write(std::span<const std::uint8_t> bytes);
  /// Whether it has not ended yet; reads its messages meanwhile.
  bool isRunning();
  /// Ends the input and waits for the program's end; kills it after its limit or once cancel() was called.
  /// True if it ended with exit code 0.
  bool finish();
  /// Makes write() and finish() return soon; may be called from any thread.
  void cancel() { cancelled_ = true; }

  /// After finish(): "ended with exit code 1" or "was ended by signal 9", or which limit it was beyond.
  const std::string& ending() const { return ending_; }
  /// Whether it was killed because it was beyond a limit.
  bool wasTooSlow() const { return !overdue_.empty(); }
  /// The last few kilobytes that it has written to stderr; the last megabyte, and what it has written to
  /// stdout too, if its output is kept.
  const std::string& messages() const { return messages_; }

 private:
  bool hasEnded() const;
  bool isOverdue(Waiting& since, std::chrono::milliseconds limit, const char* what);
  bool isLifelessAfterInterruption();
  void kill() const;
  void reap();
  void readMessages();

  pid_t pid_ = -1;  // of a program that has not been reaped, else -1
  int input_ = -1;  // our end of a socket pair
  int messagePipe_ = -1;
  std::size_t maxMessages_;  // bytes
  const ProgramLimits limits_;
  std::atomic<bool> cancelled_ = false;
  // Once the run was asked to end: the time without a sign of life, and the processor time at the last one.
  Waiting lifeless_;
  std::chrono::nanoseconds used_{-1};
  std::string overdue_;  // what it was too slow in; "" if it was not
  std::string messages_, ending_;
};

}  // namespace weir::rendering
