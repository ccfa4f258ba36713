// What was edited and not saved outlives a crash: it stands in a hidden file beside the scene's,
// ".NAME.draft".
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/studio/server/served_folder.h"
#include "framework/base/value.h"

namespace weir::studio {

/// Drafts and pictures of a scene without a file lie where those of this one would.
inline constexpr const char* kUntitled = "untitled.json";

/// What an earlier run left.
struct Draft {
  Value scene;
  std::int64_t written = 0;  ///< seconds since 1970
};

/// Nothing if there is none, or none that can be read. `path` is the scene's, "" for one without a file.
std::optional<Draft> readDraft(const ServedFolder& folder, const std::string& path);
/// Throws an io Error if it cannot be written.
void writeDraft(const ServedFolder& folder, const std::string& path, const Value& scene);
void removeDraft(const ServedFolder& folder, const std::string& path);
/// Keeps the present draft beside the next ones, as ".NAME.draft.1"; the older ones move on to .2 and .3, and
/// the last one goes.
void keepOldDraft(const ServedFolder& folder, const std::string& path);

}  // namespace weir::studio
