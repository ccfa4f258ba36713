// What Assimp may open while it reads a mesh: the mesh's own file, and regular files in its folder and below.
//
// Mesh files name others (materials, buffers, textures), by paths that whoever made the file has chosen.
#pragma once

#include <assimp/DefaultIOSystem.h>

#include <filesystem>

namespace weir {

class FolderFiles final : public Assimp::DefaultIOSystem {
 public:
  explicit FolderFiles(const std::filesystem::path& mesh);

  bool Exists(const char* file) const override;
  /// Null for a file that may not be read, and for all writing.
  Assimp::IOStream* Open(const char* file, const char* mode) override;

 private:
  bool mayRead(const std::filesystem::path& file) const;

  std::filesystem::path mesh_, folder_;
};

}  // namespace weir
