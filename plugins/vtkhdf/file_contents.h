// What checkpoints and exports hold, for `weir info FILE`.
#pragma once

#include "framework/run/file_contents.h"

namespace weir {

/// Checks every digest.
class CheckpointContents final : public FileContentsReader {
 public:
  std::vector<std::string> extensions() const override { return {".h5"}; }
  FileContents read(const std::filesystem::path& file) const override;
};

/// Of particles and of surfaces, Weir's own and those of other programs. Reads every frame, in a process of
/// its own (isolated.h).
class VtkHdfContents final : public FileContentsReader {
 public:
  std::vector<std::string> extensions() const override { return {".vtkhdf"}; }
  FileContents read(const std::filesystem::path& file) const override;
};

}  // namespace weir
