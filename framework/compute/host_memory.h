// How much memory this process can still get from the machine.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// Where the system tells about itself; tests put files of their own there.
struct SystemFiles {
  std::filesystem::path proc = "/proc";
  std::filesystem::path cgroup = "/sys/fs/cgroup";
};

/// The value of a line "key : value" of a file, or "".
std::string valueInFile(const std::filesystem::path& file, std::string_view key);

/// In bytes: the least of what the machine has available (with swap), what the control groups of this process
/// leave it (versions 1 and 2; pages of files that could be dropped count as free), and what its limit of
/// address space leaves it. 0 if the system says nothing at all.
std::size_t availableHostMemory(const SystemFiles& files = {});

}  // namespace weir
