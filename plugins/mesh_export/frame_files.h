// A folder of files, one for each frame and thing: water_00000.ply, water_00001.ply, …
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace weir {

class FrameFiles {
 public:
  /// Makes the folder if it is missing; the folder above must be there. Throws an io Error if it cannot be
  /// made, is not a folder, or if nothing can be written in it.
  FrameFiles(std::filesystem::path folder, std::string extension);

  /// Where a thing's file of a frame is; its name must be one that a file may have, as those of nodes are.
  std::filesystem::path path(std::string_view thing, std::int64_t frame) const;
  /// Writes it; one that is there is replaced when the new one is whole. Throws an io Error.
  void write(std::string_view thing, std::int64_t frame, std::string_view content) const;

 private:
  std::filesystem::path folder_;
  std::string extension_;  // ".ply"
};

}  // namespace weir
