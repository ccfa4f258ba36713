#include "framework/compute/host_memory.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <optional>

namespace weir {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();

/// The number that a file begins with; nothing if it does not, as where the limit is "max".
std::optional<std::size_t> numberIn(const fs::path& file) {
  std::ifstream in(file);
  std::size_t number = 0;
  if (!(in >> number)) return std::nullopt;
  return number;
}

/// The number behind a word at the beginning of a line.
std::size_t numberAfter(const fs::path& file, std::string_view word) {
  std::ifstream in(file);
  std::string key;
  for (std::size_t value = 0; in >> key >> value;)
    if (key == word) return value;
  return 0;
}

std::size_t kibibytes(const fs::path& file, std::string_view key) {
  return static_cast<std::size_t>(std::strtoull(valueInFile(file, key).c_str(), nullptr, 10)) * 1024;
}

/// What one control group leaves.
std::size_t leftInGroup(const fs::path& group, const char* limitFile, const char* useFile,
                        const char* files) {
  const auto limit = numberIn(group / limitFile);
  const auto use = numberIn(group / useFile);
  if (!limit || !use) return kNoLimit;
  const std::size_t droppable = numberAfter(group / "memory.stat", files);
  const std::size_t held = *use - std::min(*use, droppable);
  return *limit - std::min(*limit, held);
}

/// The least of a group and all those around it.
template <class Left>
std::size_t leastOfParents(const fs::path& root, const std::string& group, const Left& left) {
  std::size_t min = left(root);
  fs::path at = root;
  for (const fs::path& part : fs::path(group).relative_path()) min = std::min(min, left(at /= part));
  return min;
}

std::size_t leftInControlGroups(const SystemFiles& files) {
  std::size_t min = kNoLimit;
  std::ifstream in(files.proc / "self/cgroup");
  // "0::/path" is version 2, "5:memory:/path" version 1.
  for (std::string line; std::getline(in, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const std::string group = line.substr(second + 1);
    if (controllers == ",,")
      min = std::min(min, leastOfParents(files.cgroup, group, [](const fs::path& at) {
                       return leftInGroup(at, "memory.max", "memory.current", "inactive_file");
                     }));
    if (controllers.find(",memory,") != std::string::npos)
      min = std::min(min, leastOfParents(files.cgroup / "memory", group, [](const fs::path& at) {
                       return leftInGroup(at, "memory.limit_in_bytes", "memory.usage_in_bytes",
                                          "total_inactive_file");
                     }));
  }
  return min;
}

std::size_t leftOfAddressSpace(const SystemFiles& files) {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kNoLimit;
  const std::size_t max = limit.rlim_cur, used = kibibytes(files.proc / "self/status", "VmSize");
  return max - std::min(max, used);
}

}  // namespace

std::string valueInFile(const fs::path& file, std::string_view key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos || line.compare(0, key.size(), key) != 0) continue;
    const std::size_t value = line.find_first_not_of(" \t", colon + 1);
    return value == std::string::npos ? std::string() : line.substr(value);
  }
  return {};
}

std::size_t availableHostMemory(const SystemFiles& files) {
  const fs::path memory = files.proc / "meminfo";
  std::size_t min = kibibytes(memory, "MemAvailable") + kibibytes(memory, "SwapFree");
  if (min == 0) min = kNoLimit;
  min = std::min({min, leftInControlGroups(files), leftOfAddressSpace(files)});
  return min == kNoLimit ? 0 : min;
}

}  // namespace weir
