// What a file of a run holds, for `weir info FILE`: plugins that write files tell of them.
//
//   registry.addService<FileContentsReader>("checkpoints", …);
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/run/info_source.h"

namespace WEIR_API weir {

struct FileContents {
  std::string kind;                ///< "a checkpoint"
  std::vector<InfoEntry> entries;  ///< in the order in which they are shown
  std::string scene;               ///< as JSON text; empty if the file has none
};

class FileContentsReader {
 public:
  static constexpr std::string_view kInterface = "FileContentsReader";
  virtual ~FileContentsReader() = default;

  /// The endings of files that it reads, lower case with the dot.
  virtual std::vector<std::string> extensions() const = 0;
  /// Reads all of the file, so that what it returns is of a whole one. Throws an io Error that names the file
  /// if it is damaged or something else.
  virtual FileContents read(const std::filesystem::path& file) const = 0;
};

}  // namespace weir
