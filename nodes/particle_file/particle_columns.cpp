#include "nodes/particle_file/particle_columns.h"

#include <algorithm>
#include <limits>
#include <system_error>

#include "framework/base/error.h"
#include "framework/base/text.h"
#include "framework/base/value.h"
#include "framework/scene/scene_file.h"

namespace weir {

namespace {

constexpr std::array<std::string_view, 6> kSlotNames{"x", "y", "z", "vx", "vy", "vz"};
constexpr const char* kAllowed = "the columns x, y, z, and vx, vy, vz or none of these three, in any order";

/// Long lists of foreign columns are cut in messages.
std::string foundNames(const std::vector<std::string>& names) {
  constexpr std::size_t kMaxShown = 20;
  if (names.empty()) return "none";
  std::vector<std::string> shown;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxShown); ++i) shown.push_back(inQuotes(names[i]));
  if (names.size() > kMaxShown) shown.emplace_back("more");
  return joinNames(shown, " and ");
}

}  // namespace

std::string_view ParticleColumns::nameOfSlot(std::size_t slot) {
  return kSlotNames[slot];
}

ParticleColumns::ParticleColumns(const std::vector<std::string>& names) {
  std::array<int, kSlotNames.size()> found{};
  for (const std::string& name : names) {
    const auto known = std::find(kSlotNames.begin(), kSlotNames.end(), lowerCase(name));
    if (known == kSlotNames.end()) {
      slots_.emplace_back();
      unused_.push_back(name);
      continue;
    }
    const auto slot = static_cast<std::size_t>(known - kSlotNames.begin());
    if (++found[slot] > 1) throw ioError("there are two columns " + inQuotes(*known), kAllowed);
    slots_.emplace_back(slot);
  }
  const bool velocities = found[3] + found[4] + found[5] > 0;
  for (std::size_t slot = 0; slot < kSlotNames.size(); ++slot)
    if (found[slot] == 0 && (slot < 3 || velocities))
      throw ioError("there is no column " + inQuotes(kSlotNames[slot]) + "; there are " + foundNames(names),
                    kAllowed);
}

std::string readParticleFile(const std::filesystem::path& file) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(file, ignored);
  // A device or a pipe may never end. A folder or a missing file gets its message from reading it.
  if (status.type() != std::filesystem::file_type::directory && std::filesystem::exists(status) &&
      status.type() != std::filesystem::file_type::regular)
    throw ioError("the file cannot be read: it is not a regular file").at({.file = file.string()});
  return readTextFile(file, std::numeric_limits<std::size_t>::max());
}

}  // namespace weir
