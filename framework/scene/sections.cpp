#include "framework/scene/sections.h"

#include <algorithm>
#include <set>

namespace weir {

std::vector<std::string> sectionNames(const Registry& registry) {
  std::set<std::string> names(std::begin(kBundledSections), std::end(kBundledSections));
  for (const auto& [name, section] : registry.sections()) names.insert(name);
  return {names.begin(), names.end()};
}

bool isSectionName(std::string_view name, const Registry& registry) {
  const std::vector<std::string> names = sectionNames(registry);
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace weir
