// The one exception family that tells a user what went wrong, where, and what would have been right.
//
// Libraries throw; only the edge (the command line, a server, a language binding) catches. Mistakes of the
// programmer are not user errors: see check.h.
#pragma once

#include <exception>
#include <string>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// What went wrong, which is also what a program's exit code says (see exitCode).
enum class ErrorKind {
  kUsage,       ///< the command line cannot be understood
  kScene,       ///< the scene is invalid
  kSimulation,  ///< the simulation failed: diverged, NaN, out of memory, device error
  kIo,          ///< a file, folder, pipe or other program failed
};

/// Where a user finds the mistake. Every part may be empty.
struct Location {
  std::string file;
  int line = 0;         ///< from 1; 0 is unknown
  int column = 0;       ///< from 1; 0 is unknown
  std::string pointer;  ///< JSON pointer, "/nodes/water/params/spacing"
  std::string node;
  std::string parameter;
  std::string part;  ///< of a plugin: "module 'lift' (plugin lift)"
};

class Error : public std::exception {
 public:
  /// `message` is one sentence that says what was found; `allowed` what would be right; `hint` what to do.
  Error(ErrorKind kind, std::string message, std::string allowed = {}, std::string hint = {});

  Error& at(Location location);            ///< fills those parts of the location that are still empty
  Error& inNode(const std::string& name);  ///< fills the node if it is still empty
  Error& inParameter(const std::string& name);

  ErrorKind kind() const { return kind_; }
  const std::string& message() const { return message_; }
  const std::string& allowed() const { return allowed_; }
  const std::string& hint() const { return hint_; }
  const Location& location() const { return location_; }

  /// The whole text, in the order where, what, what is allowed, hint; no trailing newline.
  const char* what() const noexcept override { return text_.c_str(); }

 private:
  void compose();

  ErrorKind kind_;
  std::string message_, allowed_, hint_;
  Location location_;
  std::string text_;
};

inline Error usageError(std::string message, std::string allowed = {}, std::string hint = {}) {
  return {ErrorKind::kUsage, std::move(message), std::move(allowed), std::move(hint)};
}
inline Error sceneError(std::string message, std::string allowed = {}, std::string hint = {}) {
  return {ErrorKind::kScene, std::move(message), std::move(allowed), std::move(hint)};
}
inline Error simulationError(std::string message, std::string allowed = {}, std::string hint = {}) {
  return {ErrorKind::kSimulation, std::move(message), std::move(allowed), std::move(hint)};
}
inline Error ioError(std::string message, std::string allowed = {}, std::string hint = {}) {
  return {ErrorKind::kIo, std::move(message), std::move(allowed), std::move(hint)};
}

/// Exit codes of every Weir program.
enum ExitCode : int {
  kDone = 0,
  kUsage = 2,
  kInvalidScene = 3,
  kSimulationFailed = 4,
  kIoFailed = 5,
  kInterrupted = 130
};

ExitCode exitCode(ErrorKind kind);

}  // namespace weir
