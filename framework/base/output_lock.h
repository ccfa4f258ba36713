// Who writes an output: two runs that write into the same file or folder would spoil both.
#pragma once

#include <filesystem>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// While this lives, no other process can have a lock of the same path. It is a file beside the output,
/// ".NAME.lock", which is removed at the end; one that a killed process left behind holds nobody up. Where
/// the file system knows no locks, there is none.
class OutputLock {
 public:
  /// Throws an io Error that says who has it if it is taken. The path is a file or a folder and need not
  /// exist.
  explicit OutputLock(const std::filesystem::path& output);
  ~OutputLock();
  OutputLock(OutputLock&& other) noexcept;
  OutputLock& operator=(OutputLock&&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace weir
