#include "framework/run/output_paths.h"

#include <algorithm>
#include <cctype>

#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir {

namespace fs = std::filesystem;

namespace {

/// "a file that ends in .mp4, .mkv"
std::string allowedEndings(const OutputOption& option) {
  std::string text;
  for (const std::string& ending : option.extensions) text += (text.empty() ? "" : ", ") + ending;
  return "a file that ends in " + text;
}

}  // namespace

void checkOutputPath(const OutputOption& option, const fs::path& path, const std::string& what) {
  if (!option.isFolder()) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (std::find(option.extensions.begin(), option.extensions.end(), ending) == option.extensions.end())
      throw usageError(what + (ending.empty() ? " has no ending" : " ends in " + printable(ending)),
                       allowedEndings(option));
  }
  std::error_code error;
  const fs::path above = fs::absolute(path).lexically_normal().parent_path();
  if (!fs::is_directory(above, error))
    throw ioError(what + ": there is no folder " + inQuotes(above.string()),
                  "a path in a folder that exists");
}

}  // namespace weir
