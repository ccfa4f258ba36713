// Names of the sections that a scene may have beside its fixed keys.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/graph/registry.h"

namespace weir {

/// Sections of plugins that come with Weir. Where such a plugin is not loaded, its section is kept unread, so
/// that a scene with pictures also runs in a build without them.
inline constexpr std::string_view kBundledSections[] = {"render"};

/// The registered and the bundled sections, sorted.
std::vector<std::string> sectionNames(const Registry& registry);
bool isSectionName(std::string_view name, const Registry& registry);

}  // namespace weir
