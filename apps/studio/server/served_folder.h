// The folder whose files the studio may read and write. No path leads out of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace weir::studio {

struct ServedFile {
  std::string path;  ///< below the folder, with '/'
  std::int64_t bytes = 0;
  std::int64_t modified = 0;  ///< s since 1970; 0 where nobody knows
  bool isFolder = false;
};

/// The whole of a regular file. Throws an io Error that calls it `name` if it cannot be read, and for all
/// that is not a regular file: a pipe or a device might keep the studio waiting for ever.
std::string readRegularFile(const std::filesystem::path& file, std::string_view name);

class ServedFolder {
 public:
  static constexpr std::int64_t kLargestUpload = std::int64_t{256} << 20;
  static constexpr std::size_t kMaxListed = 5000;

  /// Throws an io Error if there is no such folder.
  explicit ServedFolder(const std::filesystem::path& folder);

  const std::filesystem::path& root() const { return root_; }
  /// Where a path below the folder is. Throws a usage Error if it is absolute, is not in UTF-8, has control
  /// characters, leads out of the folder, also by a link, or to something hidden (".git/config").
  std::filesystem::path resolve(std::string_view path) const;
  /// Whether a path of the file system leads to a file or folder below this one that is not hidden, or to
  /// where one could be made; links are resolved.
  bool contains(const std::filesystem::path& path) const;
  /// What lies directly in a folder below this one, sorted, hidden files left out; nothing where there is no
  /// such folder yet. Throws an io Error if it cannot be read.
  std::vector<ServedFile> list(std::string_view folder) const;
  /// Both throw an io Error if the file cannot be read or written, see readRegularFile.
  std::string read(std::string_view path) const;
  void write(std::string_view path, std::string_view content) const;
  /// A hidden file beside the one at the path, of a name that nobody has, for what take() makes it of.
  std::filesystem::path partOf(std::string_view path) const;
  /// Puts such a file at the path. Throws an io Error if that cannot be.
  void take(const std::filesystem::path& part, std::string_view path) const;

 private:
  /// Where a file may be written, in a folder that is made.
  std::filesystem::path placeFor(std::string_view path) const;

  std::filesystem::path root_;  // canonical
};

}  // namespace weir::studio
