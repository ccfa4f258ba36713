#include "plugins/assimp/folder_files.h"

#include <algorithm>
#include <string_view>
#include <system_error>

namespace weir {

namespace fs = std::filesystem;

FolderFiles::FolderFiles(const fs::path& mesh) : mesh_(fs::absolute(mesh)) {
  std::error_code error;
  folder_ = fs::canonical(mesh_.parent_path(), error);
}

bool FolderFiles::mayRead(const fs::path& file) const {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  if (fs::absolute(file, error) == mesh_) return true;  // perhaps a link, which the scene has named
  const fs::path real = fs::canonical(file, error);     // without links and ".."
  if (error || folder_.empty()) return false;
  const auto [inFolder, inReal] = std::mismatch(folder_.begin(), folder_.end(), real.begin(), real.end());
  return inFolder == folder_.end();
}

bool FolderFiles::Exists(const char* file) const {
  return file != nullptr && mayRead(file);
}

Assimp::IOStream* FolderFiles::Open(const char* file, const char* mode) {
  const bool reads = mode != nullptr && std::string_view(mode).find_first_of("wa+") == std::string_view::npos;
  return reads && Exists(file) ? DefaultIOSystem::Open(file, mode) : nullptr;
}

}  // namespace weir
