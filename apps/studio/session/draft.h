// What was edited and not saved outlives a crash: it stands in a hidden file beside the scene's,
// ".NAME.draft".
#pragma once

#include <optional>
#include <string>

#include "apps/studio/server/served_folder.h"
#include "framework/base/value.h"

namespace weir::studio {

/// Nothing if there is none, or none that can be read. `path` is the scene's, "" for one without a file.
std::optional<Value> readDraft(const ServedFolder& folder, const std::string& path);
/// Throws an io Error if it cannot be written.
void writeDraft(const ServedFolder& folder, const std::string& path, const Value& scene);
void removeDraft(const ServedFolder& folder, const std::string& path);

}  // namespace weir::studio
