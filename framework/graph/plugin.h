// Plugins: shared libraries that add to the registry at run time; plugin_header.h has what is in one.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "framework/base/api.h"
#include "framework/graph/registry.h"

namespace WEIR_API weir {

/// A loaded library. It stays loaded for as long as this or the registry lives; all that is made of its types
/// must be gone by then.
class Plugin {
 public:
  /// Loads and registers. Throws an io Error if the file cannot be loaded, is not a plugin, is of another
  /// version or build, or fails to register; the registry is then as before.
  Plugin(const std::filesystem::path& file, Registry& registry);
  ~Plugin();
  Plugin(Plugin&&) noexcept;
  Plugin& operator=(Plugin&&) noexcept;

  const std::string& name() const { return name_; }
  const std::string& doc() const { return doc_; }
  const std::filesystem::path& file() const { return file_; }
  /// Whether its kernels, if it has any, run on CUDA.
  bool hasCudaKernels() const { return hasCudaKernels_; }

 private:
  struct Library;
  std::shared_ptr<Library> library_;
  std::filesystem::path file_;
  std::string name_, doc_;
  bool hasCudaKernels_ = false;
};

/// Every *.so of a folder, by name; none if there is no such folder.
std::vector<std::filesystem::path> pluginFiles(const std::filesystem::path& folder);

}  // namespace weir
